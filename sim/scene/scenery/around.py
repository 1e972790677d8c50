"""Everything that stands around in a scenario: its listed things, its scenery, its parked vehicles."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from datmo.arrays import F64
from scenarios import spec
from sim.scene.roads import Road
from sim.scene.scenery.parking import Parked, parked
from sim.scene.scenery.plot import rectangle, room
from sim.scene.scenery.scatter import scatter
from sim.scene.terrain import Terrain

THINGS, PARKED = 2**30, 2**30 + 1
"""Keys of the streams: beyond those of a world's ground, traffic and walkers."""
WALK, DRIVE = 2.0, 4.0  # widths kept free for listed walkers and actors [m]
SPARE = 1.5  # kept free before and behind their way-points [m]


def around(
    scenario: spec.Scenario, roads: Sequence[Road], terrain: Terrain, seed: np.random.SeedSequence
) -> tuple[tuple[spec.Thing, ...], tuple[Parked, ...]]:
    """The things of a scenario, those listed first, and its parked vehicles.

    Args:
        seed: of the world; the streams of others are left alone.
    """
    scenery, area = scenario.scenery, terrain.area
    taken = [*map(room, scenario.things), *ways(scenario)]
    standing = parked(scenery, roads, _child(seed, PARKED), area, taken)
    taken += [one.corners for one in standing]
    return (*scenario.things, *scatter(scenery, roads, terrain, area, _child(seed, THINGS), taken)), standing


def ways(scenario: spec.Scenario) -> list[F64]:
    """Polygons (4, 2) that the listed walkers and actors need [m, world]."""
    lines = [([walk.start, walk.goal], WALK) for walk in scenario.pedestrians]
    lines += [([(p.x, p.y) for p in (*actor.path, actor.path[-1])], DRIVE) for actor in scenario.actors]
    return [_lane(np.array(a), np.array(b), width) for line, width in lines for a, b in pairwise(line)]


def _lane(a: F64, b: F64, width: float) -> F64:
    along = b - a
    length = float(np.hypot(*along)) + 2 * max(SPARE, width / 2)
    return rectangle((a + b) / 2, float(np.arctan2(along[1], along[0])), length, width)


def _child(seed: np.random.SeedSequence, key: int) -> np.random.SeedSequence:
    return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, key))
