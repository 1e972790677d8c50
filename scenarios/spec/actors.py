"""Actors that follow a script."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

from pydantic import Field, model_validator

from scenarios.spec.base import Model


class WayPoint(Model):
    """Where a scripted actor is at a time."""

    t: float = Field(description="[s] since the first scan; may be negative")
    x: float = Field(description="[m, world]")
    y: float = Field(description="[m, world]")


class Actor(Model):
    """A scripted actor: parked at one way-point, or driven smoothly through several."""

    name: str
    kind: Literal["car", "truck", "pedestrian"]
    path: tuple[WayPoint, ...] = Field(min_length=1)
    yaw_deg: float | None = Field(None, description="heading where the path has one point [deg, world]")
    variant: int = Field(0, ge=0, description="which mesh of its kind")

    @model_validator(mode="after")
    def _in_order(self) -> Actor:
        times = [p.t for p in self.path]
        if any(b <= a for a, b in pairwise(times)):
            raise ValueError(f"times {times} of the path must increase; put the way-points in order")
        return self
