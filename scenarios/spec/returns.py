"""What a real sensor adds to and takes from the ideal one, and the weather in which it works."""

from __future__ import annotations

from pydantic import Field

from scenarios.spec.base import Model


class Noise(Model):
    """What the ideal sensor does not have; every effect can be switched off (see `IDEAL`)."""

    range_std: float = Field(
        0.0075, ge=0, le=1, description="standard deviation of range where light is plenty [m]; 0 for none"
    )
    drop_out: float = Field(0.01, ge=0, le=1, description="isolated drop-outs, share of returns")
    grazing: bool = Field(True, description="lose returns by range, incidence and material")
    intensity: bool = Field(True, description="intensity scatters about its material's, and is 0 where faint")
    response: float = Field(
        0.25, ge=0, le=0.5, description="standard deviation of the lasers' response in intensity, share"
    )
    edges: bool = Field(True, description="a beam that straddles an edge meets both surfaces")
    divergence_mrad: float = Field(2.0, gt=0, le=10, description="full angle of the beam, for edges [mrad]")
    multipath: bool = Field(True, description="shiny surfaces send the beam on: returns below the ground")


IDEAL = Noise(
    range_std=0, drop_out=0, grazing=False, intensity=False, response=0, edges=False, multipath=False
)
"""Every effect off: range and intensity are those of the surface that was met."""


class Weather(Model):
    """What is in the air; all zero is clear."""

    rain_mm_h: float = Field(0.0, ge=0, le=150, description="rate of rain [mm/h]")
    snow_mm_h: float = Field(0.0, ge=0, le=20, description="rate of snow, melted [mm/h]")
    fog_visibility_m: float | None = Field(
        None, ge=10, le=10_000, description="meteorological optical range in fog [m]; null for none"
    )
