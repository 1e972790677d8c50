"""What the rays met, beyond geometry: kind, thing, reflectivity and the mean intensity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, I32, U8
from datmo.messages import Kind
from sim.scan.bodies import Body
from sim.scan.caster import Hits
from sim.scan.merge import TERRAIN, THING
from sim.scan.things import Things

REFLECTIVITY = {Kind.ROAD: 0.1, Kind.SIDEWALK: 0.2, Kind.FIELD: 0.3}
"""Of the ground, diffuse, at 905 nm: asphalt, paving, grass and soil."""
LEVEL = {Kind.ROAD: 0.22, Kind.SIDEWALK: 0.31, Kind.FIELD: 0.36, Kind.WALL: 0.24, Kind.POLE: 0.3}
"""Mean intensity where it is not 0; with the zeros, the class means of real HDL-64 sweeps."""
GLOSS = {Kind.PEDESTRIAN: 0.7}
"""Mean intensity of a moving body as a share of its reflectivity; most paint throws the light away."""
PAINTED = 0.2


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Per ray (m,): kind, thing (id, -1 none), reflectivity, level (mean intensity)."""

    kind: U8
    thing: I32
    reflectivity: F32
    level: F32


def _table(values: dict[Kind, float], default: float = 0.0) -> F32:
    table = np.full(len(Kind), default, np.float32)
    for kind, value in values.items():
        table[kind] = value
    return table


def surfaces(
    hits: Hits, terrain_kind: U8, things: Things | None, bodies: Sequence[Body], kinds: U8
) -> Surfaces:
    """Look up what each ray met.

    Args:
        terrain_kind: (cells,) kind of each cell of the terrain; triangles 2 c and 2 c + 1 are cell c.
        bodies: of the k actors, and their kinds (k,).
    """
    m = len(hits.winner)
    kind, thing = np.zeros(m, np.uint8), np.full(m, -1, np.int32)
    ground = np.flatnonzero(hits.winner == TERRAIN)
    kind[ground] = terrain_kind[hits.triangle[ground] // 2]
    if things is not None:
        rays = np.flatnonzero(hits.winner == THING)
        kind[rays], thing[rays] = things.kind[hits.triangle[rays]], things.thing[hits.triangle[rays]]
    reflectivity, level = _table(REFLECTIVITY)[kind], _table(LEVEL)[kind]
    if things is not None:
        reflectivity[rays] = things.reflectivity[hits.triangle[rays]]
    rays = np.flatnonzero(hits.winner >= 0)
    row = hits.winner[rays]
    kind[rays] = kinds[row]
    gloss = _table(GLOSS, PAINTED)
    for k, body in enumerate(bodies):
        mine = rays[row == k]
        rho = body.reflectivity[hits.triangle[mine]]
        reflectivity[mine], level[mine] = rho, gloss[kinds[k]] * rho
    return Surfaces(kind, thing, reflectivity, level)
