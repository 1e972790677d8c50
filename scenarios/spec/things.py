"""Static scenery."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from scenarios.spec.base import Model, Point, Positive


class Thing(Model):
    """Static scenery that stands on the terrain."""

    kind: Literal["pole", "wall"]
    at: Point = Field(description="[m, world]")
    size: tuple[Positive, Positive, Positive] = Field(description="length, width, height [m]")
    yaw_deg: float = 0.0
