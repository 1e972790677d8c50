"""What a real sensor adds to and takes from the ideal one."""

from __future__ import annotations

from pydantic import Field

from scenarios.spec.base import Model


class Noise(Model):
    """What the ideal sensor does not have."""

    range_std: float = Field(0.01, ge=0, le=1, description="standard deviation of range [m]")
    drop_out: float = Field(0.01, ge=0, le=1, description="isolated drop-outs, share of returns")
    grazing: bool = Field(True, description="lose returns by range, incidence and material")
