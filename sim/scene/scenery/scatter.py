"""Things set along the roads and strewn over the field by the rules of a scenario."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from datmo.arrays import F64
from datmo.messages import Kind
from scenarios import spec
from sim.scene.roads import Road
from sim.scene.scenery.edges import Edges
from sim.scene.scenery.kinds import SORTS, drawn
from sim.scene.scenery.plot import Plots, needed
from sim.scene.scenery.verge import Verge, verges
from sim.scene.terrain import Terrain

Area = tuple[float, float, float, float]
SHAPES = 12
"""Different shapes of a kind in a scene; each is made once."""
SQUARE = 100.0  # side of the squares that draw by themselves: a hectare [m]
PAVED = 8.0  # a sidewalk is at most so wide [m]
STEP = 0.25  # in which its back is looked for [m]
SPARE = 0.05  # more than needed, for roads that bend [m]
PIECE = 1  # decimals to which the length of a line's piece is rounded, so that shapes can be shared


def scatter(
    scenery: spec.Scenery,
    roads: Sequence[Road],
    terrain: Terrain,
    area: Area,
    seed: np.random.SeedSequence,
    taken: Sequence[F64] = (),
) -> tuple[spec.Thing, ...]:
    """The things that a scenery's rules make: on the field, off roads and sidewalks, none inside another.

    Each rule draws from streams of its own. Earlier rules take their ground first: rows, then what is strewn.

    Args:
        area: x_min, y_min, x_max, y_max where they may have their middle [m, world].
        taken: polygons (p, 2) that stay free, such as ways of walkers [m, world].
    """
    edges = Edges(roads)
    plots = Plots(edges, terrain, taken)
    things: list[spec.Thing] = []
    for i, row in enumerate(scenery.all_rows):
        for k, verge in enumerate(verges(roads, row.side)):
            rng = np.random.default_rng(_child(seed, 0, i, k))
            along = _line if SORTS[row.kind].line else _places
            things += [
                thing
                for thing in along(row, verge, terrain, rng)
                if _within(area, thing) and plots.take(thing)
            ]
    for i, rule in enumerate(scenery.all_strewn):
        strewn = _strewn(rule, area, _child(seed, 1, i))
        things += [
            thing for thing in strewn if _reached(rule, edges, thing) and plots.take(thing, rule.clear)
        ]
    return tuple(things)


def _places(row: spec.Row, verge: Verge, terrain: Terrain, rng: np.random.Generator) -> Iterator[spec.Thing]:
    """Single things along a verge."""
    n = int(verge.length / row.every) + 1
    arc = (np.arange(n, dtype=float) + rng.uniform()) * row.every + rng.uniform(-row.jitter, row.jitter, n)
    offset, taken = rng.uniform(*row.offset, n), rng.uniform(0, 1, n) < row.share
    seeds = rng.integers(SHAPES, size=n)
    on = taken & (arc >= 0) & (arc <= verge.length)
    free = _behind(verge, arc[on], terrain)
    for s, off, shape in zip(arc[on], offset[on] + free, seeds[on], strict=True):
        size = row.size or drawn(row.kind, int(shape))
        beside = max(off + SORTS[row.kind].foot * size[1] / 2, needed(row.kind, size) + SPARE)
        x, y = verge.at(np.array([s]), np.array([beside]))[0]
        yield _thing(row.kind, (x, y), verge.yaw(float(s)), int(shape), row.size)


def _line(row: spec.Row, verge: Verge, terrain: Terrain, rng: np.random.Generator) -> Iterator[spec.Thing]:
    """Pieces of a wall, fence, rail or hedge along a verge, end to end; all of one height."""
    n = int(verge.length / row.every)
    shape, offset = int(rng.integers(SHAPES)), float(rng.uniform(*row.offset))
    here = _runs(n, row.share, rng)
    if not n:
        return
    size = row.size or drawn(row.kind, shape)
    arc: F64 = (verge.length - n * row.every) / 2 + np.arange(n + 1, dtype=float) * row.every
    ends = verge.at(arc, _behind(verge, arc, terrain) + offset + size[1] / 2)
    for i in np.flatnonzero(here):
        along = ends[i + 1] - ends[i]
        length = max(round(float(np.hypot(*along)), PIECE), 0.5)
        x, y = (ends[i] + ends[i + 1]) / 2
        yield _thing(row.kind, (x, y), float(np.arctan2(along[1], along[0])), shape, (length, *size[1:]))


def _runs(n: int, share: float, rng: np.random.Generator) -> F64:
    """Which of n pieces stand: in runs of several, a share of them on average."""
    draws, length = rng.uniform(0, 1, n), rng.integers(2, 6, n)
    run = np.repeat(np.arange(n), length)[:n]
    return np.asarray(draws[run] < share)


def _behind(verge: Verge, arc: F64, terrain: Terrain) -> F64:
    """How far (n,) beyond the road's edge the field begins [m]: 0, or the back of the sidewalk."""
    steps = np.arange(0.0, PAVED, STEP) + STEP / 2
    points = np.concatenate([verge.at(arc, np.full(len(arc), s)) for s in steps])
    kind = terrain.kind_at(points).reshape(len(steps), len(arc))
    paved = np.where(kind == Kind.SIDEWALK, steps[:, None] + STEP / 2, 0.0)
    return np.asarray(paved.max(0))


def _strewn(rule: spec.Strewn, area: Area, seed: np.random.SeedSequence) -> Iterator[spec.Thing]:
    """A Poisson process on squares of the world's own lattice: a wider area finds the same things."""
    (i0, j0), (i1, j1) = ([int(np.floor(v / SQUARE)) for v in corner] for corner in (area[:2], area[2:]))
    for j in range(j0, j1 + 1):
        for i in range(i0, i1 + 1):
            rng = np.random.default_rng(_child(seed, *(2 * abs(v) + (v < 0) for v in (i, j))))
            n = int(rng.poisson(rule.density))
            places = (rng.uniform(0, 1, (n, 2)) + np.array([i, j])) * SQUARE
            yaw, shape = rng.uniform(-np.pi, np.pi, n), rng.integers(SHAPES, size=n)
            for (x, y), turn, one in zip(places, yaw, shape, strict=True):
                thing = _thing(rule.kind, (x, y), turn, int(one), rule.size)
                if _within(area, thing):
                    yield thing


def _thing(
    kind: spec.ThingKind,
    at: tuple[float, float],
    yaw: float,
    seed: int,
    size: tuple[float, float, float] | None,
) -> spec.Thing:
    return spec.Thing(
        kind=kind,
        at=(round(float(at[0]), 3), round(float(at[1]), 3)),
        size=size,
        yaw_deg=round(float(np.degrees(yaw)), 2),
        seed=seed,
    )


def _reached(rule: spec.Strewn, edges: Edges, thing: spec.Thing) -> bool:
    if rule.reach is None:
        return True
    return bool(edges.beyond(np.array([thing.at]), rule.reach)[0] < rule.reach)


def _within(area: Area, thing: spec.Thing) -> bool:
    return area[0] <= thing.at[0] <= area[2] and area[1] <= thing.at[1] <= area[3]


def _child(seed: np.random.SeedSequence, *key: int) -> np.random.SeedSequence:
    return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, *key))
