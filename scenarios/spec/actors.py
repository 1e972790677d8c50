"""Actors that follow a script."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

from pydantic import Field, model_validator

from scenarios.spec.base import Model, Positive

ActorKind = Literal["car", "van", "truck", "bus", "motorcycle", "bicycle", "pedestrian", "child"]


class WayPoint(Model):
    """Where a scripted actor is at a time. It stands on the ground: there is no height to give."""

    t: float = Field(description="[s] since the first scan; may be negative")
    x: float = Field(description="[m, world]")
    y: float = Field(description="[m, world]")


class Cue(Model):
    """What sets a scripted actor going."""

    distance: Positive = Field(description="so near must the ego come to the first way-point [m]")


class Actor(Model):
    """A scripted actor: parked at one way-point, or driven smoothly through several."""

    name: str
    kind: ActorKind
    path: tuple[WayPoint, ...] = Field(min_length=1)
    yaw_deg: float | None = Field(None, description="heading where the path has one point [deg, world]")
    variant: int = Field(0, ge=0, description="which mesh of its kind")
    trigger: Cue | None = Field(None, description="stands at its first way-point until then")

    @model_validator(mode="after")
    def _in_order(self) -> Actor:
        times = [p.t for p in self.path]
        if any(b <= a for a, b in pairwise(times)):
            raise ValueError(f"times {times} of the path must increase; put the way-points in order")
        if self.trigger and len(times) == 1:
            raise ValueError("a trigger needs at least two way-points; add one, or drop the trigger")
        return self
