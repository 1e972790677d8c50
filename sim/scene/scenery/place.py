"""A thing set on the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, F64, I32, U8
from scenarios import spec
from sim.scene.scenery.kinds import drawn, form
from sim.scene.terrain import Terrain


@dataclass(frozen=True, eq=False)
class Standing:
    """A thing in the world.

    Attributes:
        vertices: (v, 3) [m, world]. triangles: (t, 3).
        kind: (t,) of datmo.messages.Kind. reflectivity: (t,) diffuse, 0..1, at 905 nm.
        size: length, width, height above the ground [m].
    """

    vertices: F32
    triangles: I32
    kind: U8
    reflectivity: F32
    size: tuple[float, float, float]


def size_of(thing: spec.Thing) -> tuple[float, float, float]:
    """Length, width, height above the ground [m]: as given, or drawn by the seed."""
    return drawn(thing.kind, thing.seed) if thing.size is None else thing.size


def stand(thing: spec.Thing, terrain: Terrain) -> Standing:
    """The thing's triangles on the ground, rooted a little below it."""
    size = size_of(thing)
    own = form(thing.kind, size, thing.seed)
    ground = terrain.height_at(_placed(thing, own.foot))
    vertices = np.column_stack([_placed(thing, own.vertices[:, :2]), ground + own.vertices[:, 2]])
    return Standing(
        np.ascontiguousarray(vertices, np.float32),
        own.triangles.astype(np.int32),
        own.kind,
        own.reflectivity.astype(np.float32),
        size,
    )


def _placed(thing: spec.Thing, xy: F64) -> F64:
    """(n, 2) from the thing's own axes to the world's."""
    c, s = np.cos(np.radians(thing.yaw_deg)), np.sin(np.radians(thing.yaw_deg))
    x, y = xy[:, 0], xy[:, 1]
    return np.asarray(np.column_stack([c * x - s * y, s * x + c * y]) + np.array(thing.at))
