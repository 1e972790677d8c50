"""What a real sensor adds to and takes from the ideal one, and the weather in which it works."""

from __future__ import annotations

from pydantic import Field

from scenarios.spec.base import Model


class Noise(Model):
    """What the ideal sensor does not have; every effect can be switched off."""

    range_std: float = Field(0.01, ge=0, le=1, description="standard deviation of range [m]; 0 for none")
    drop_out: float = Field(0.01, ge=0, le=1, description="isolated drop-outs, share of returns")
    grazing: bool = Field(True, description="lose returns by range, incidence and material")
    speckle: bool = Field(True, description="intensity scatters about its material's, and is 0 where faint")
    divergence_mrad: float = Field(
        1.5, ge=0, le=10, description="full angle of the beam: returns mix at edges [mrad]; 0 for none"
    )
    multipath: bool = Field(True, description="shiny surfaces send the beam on: returns below the ground")


class Weather(Model):
    """What is in the air; all zero is clear."""

    rain: float = Field(0.0, ge=0, le=150, description="rate [mm/h]")
    snow: float = Field(0.0, ge=0, le=20, description="rate, of melted snow [mm/h]")
    visibility: float | None = Field(
        None, ge=10, le=10_000, description="meteorological optical range in fog [m]; null for none"
    )
