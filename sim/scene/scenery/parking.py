"""Vehicles that stand parked beside the roads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.messages import Kind
from scenarios import spec
from sim.scene.assets import asset, keys
from sim.scene.roads import Road
from sim.scene.scenery.edges import Edges
from sim.scene.scenery.plot import CLOSE, outline, overlap, rectangle
from sim.scene.scenery.verge import Verge, verges

Area = tuple[float, float, float, float]
CLEAR = 5.0  # free of parked vehicles before and behind another road [m]
LOOKS = 6  # that vehicles of one model come in, of the catalogue's seeds
SPARE = {False: 0.5, True: 0.6}  # of a place, along and across, for manoeuvres and doors [m]
ASKEW = 0.02  # spread of how vehicles stand to the road [rad]


@dataclass(frozen=True, eq=False)
class Parked:
    """A vehicle that stands.

    Attributes:
        asset: key of its mesh. kind: of vehicle. xy: (2,) its middle [m, world]. yaw: [rad].
    """

    asset: str
    kind: Kind
    xy: F64
    yaw: float

    @property
    def corners(self) -> F64:
        """Of its box (4, 2) [m, world]."""
        length, width, _ = asset(self.asset).size
        return rectangle(self.xy, self.yaw, length, width)


def parked(
    scenery: spec.Scenery,
    roads: Sequence[Road],
    seed: np.random.SeedSequence,
    area: Area,
    taken: Sequence[F64] = (),
) -> tuple[Parked, ...]:
    """The vehicles that a scenery's parking makes, off every road, heading with the traffic.

    Args:
        area: x_min, y_min, x_max, y_max where they may have their middle [m, world].
        taken: polygons (p, 2) that stay free [m, world].
    """
    edges, found = Edges(roads), list[Parked]()
    for r, rule in enumerate(scenery.parking):
        for k, verge in enumerate(verges(roads, rule.side)):
            key = (*seed.spawn_key, r, k)
            rng = np.random.default_rng(np.random.SeedSequence(seed.entropy, spawn_key=key))
            for one, row in _row(rule, verge, rng):
                x, y = one.xy
                inside = area[0] <= x <= area[2] and area[1] <= y <= area[3]
                if inside and _free(one, row, edges, found, taken):
                    found.append(one)
    return tuple(found)


def _row(rule: spec.Parking, verge: Verge, rng: np.random.Generator) -> Iterator[tuple[Parked, F64]]:
    """The vehicles of one side of a road, and the polygon (4, 2) that each needs off other roads."""
    n = int(verge.length / rule.place)
    here, sort, askew = rng.uniform(0, 1, n) < rule.share, rng.uniform(0, 1, n), rng.normal(0, ASKEW, n)
    turn = np.where(rng.uniform(0, 1, n) < 0.5, 1, -1) * (np.pi / 2 if rule.across else 0.0)
    for i in np.flatnonzero(here):
        s = (i + 0.5) * rule.place
        key, kind = _which(rule, float(sort[i]), rng)
        along, deep = np.array(asset(key).size[:2])[:: -1 if rule.across else 1]
        if along > rule.place - SPARE[rule.across]:
            continue
        xy = verge.at(np.array([s]), np.array([rule.gap + deep / 2 + ASKEW * along]))[0]
        row = rectangle(xy, verge.yaw(s), along + 2 * CLEAR, 0.5 * deep)
        yield Parked(key, kind, xy, verge.yaw(s) + float(askew[i] + turn[i])), row


def _which(rule: spec.Parking, share: float, rng: np.random.Generator) -> tuple[str, Kind]:
    """A vehicle's key and kind."""
    kind = Kind.TRUCK if share < rule.trucks else Kind.VAN if share < rule.trucks + rule.vans else Kind.CAR
    some = keys(kind)
    return f"{some[int(rng.integers(len(some)))]}~{int(rng.integers(LOOKS))}", kind


def _free(one: Parked, row: F64, edges: Edges, others: Sequence[Parked], taken: Sequence[F64]) -> bool:
    """Whether it stands off the roads, with room on either side of it in the row, and off all else."""
    points = np.concatenate([outline(one.corners), outline(row)])
    if edges.beyond(points, CLOSE).min() < CLOSE:
        return False
    reach = asset(one.asset).size[0]
    near = [other.corners for other in others if np.hypot(*(one.xy - other.xy)) < 2 * reach]
    return not any(overlap(one.corners, polygon) for polygon in (*near, *taken))
