"""Static scenery."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from scenarios.spec.base import Model, Point, Positive

ThingKind = Literal[
    "pole",
    "lamp",
    "sign",
    "traffic_light",
    "bollard",
    "bin",
    "container",
    "wall",
    "fence",
    "rail",
    "hedge",
    "building",
    "tree",
    "conifer",
    "bush",
    "grass",
]
Size = tuple[Positive, Positive, Positive]


class Thing(Model):
    """Static scenery that stands on the terrain.

    Its x axis runs along the traffic and y towards the road: a lamp's arm and a rail's beam point along +y,
    a sign faces -x.
    """

    kind: ThingKind
    at: Point = Field(description="[m, world]")
    size: Size | None = Field(
        None, description="length, width, height above the ground [m]; null: drawn within the kind's limits"
    )
    yaw_deg: float = Field(0.0, description="of its x axis, counter-clockwise from the world's [deg]")
    seed: int = Field(0, ge=0, description="of its shape, and of its size where that is null")
