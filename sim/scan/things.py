"""Static things (trees, walls, buildings ...) joined into one mesh that rays are cast against."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, I32, U8
from scenarios import spec
from sim.scan.embree import Mesh
from sim.scene.scenery.place import stand
from sim.scene.terrain import Terrain


@dataclass(frozen=True, eq=False)
class Things:
    """All static things of a run, one scene in the world frame.

    Per triangle (t,): `thing` the id, `kind`, `reflectivity`.
    """

    mesh: Mesh
    thing: I32
    kind: U8
    reflectivity: F32


def place(things: Sequence[spec.Thing], terrain: Terrain) -> Things | None:
    """The things of a scenario on its ground; thing i has id i. None where there are none."""
    if not things:
        return None
    shapes = [stand(thing, terrain) for thing in things]
    first = np.cumsum([0] + [len(shape.vertices) for shape in shapes[:-1]], dtype=np.int32)
    triangles = [shape.triangles + start for shape, start in zip(shapes, first, strict=True)]
    each = [len(shape.triangles) for shape in shapes]
    return Things(
        mesh=Mesh(np.concatenate([shape.vertices for shape in shapes]), np.concatenate(triangles)),
        thing=np.repeat(np.arange(len(shapes), dtype=np.int32), each),
        kind=np.concatenate([shape.kind for shape in shapes]),
        reflectivity=np.concatenate([shape.reflectivity for shape in shapes]),
    )
