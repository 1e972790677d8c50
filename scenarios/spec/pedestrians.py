"""People on foot."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from scenarios.spec.base import Model, Point


class Pedestrian(Model):
    """A walker from `start` to `goal`, there and back while the scenario lasts."""

    behaviour: Literal["crossing", "strolling", "waiting"] = "crossing"
    start: Point = Field(description="[m, world]")
    goal: Point = Field(description="[m, world]")
    speed: float = Field(1.4, gt=0, le=7, description="[m/s]")
    begin: float = Field(0.0, ge=0, description="waits at the start until then [s]")
