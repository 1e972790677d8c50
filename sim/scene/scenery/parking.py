"""Vehicles that stand parked beside the roads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.messages import Kind
from scenarios import spec
from sim.scene.assets import asset, keys
from sim.scene.roads import Road
from sim.scene.scenery.edges import Edges
from sim.scene.scenery.plot import CLOSE, outline, overlap, rectangle
from sim.scene.scenery.verge import verges

Area = tuple[float, float, float, float]
CLEAR = 5.0  # free of parked vehicles before and behind another road [m]
LOOKS = 6  # that vehicles of one model come in, of the catalogue's seeds
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
    rule = scenery.parking
    edges, found = Edges(roads), list[Parked]()
    for k, verge in enumerate(verges(roads, rule.side) if rule else ()):
        assert rule is not None
        rng = np.random.default_rng(np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, k)))
        n = int(verge.length / rule.every)
        here, sort, askew = rng.uniform(0, 1, n) < rule.share, rng.uniform(0, 1, n), rng.normal(0, ASKEW, n)
        for i in np.flatnonzero(here):
            s = (i + 0.5) * rule.every
            key, kind = _which(rule, float(sort[i]), rng)
            length, width, _ = asset(key).size
            if length > rule.every - 0.5:
                continue
            xy = verge.at(np.array([s]), np.array([rule.gap + width / 2 + ASKEW * length]))[0]
            one = Parked(key, kind, xy, verge.yaw(s) + float(askew[i]))
            inside = area[0] <= xy[0] <= area[2] and area[1] <= xy[1] <= area[3]
            if inside and _free(one, edges, found) and not any(overlap(one.corners, p) for p in taken):
                found.append(one)
    return tuple(found)


def _which(rule: spec.Parking, share: float, rng: np.random.Generator) -> tuple[str, Kind]:
    """A vehicle's key and kind."""
    kind = Kind.TRUCK if share < rule.trucks else Kind.VAN if share < rule.trucks + rule.vans else Kind.CAR
    some = keys(kind)
    return f"{some[int(rng.integers(len(some)))]}~{int(rng.integers(LOOKS))}", kind


def _free(one: Parked, edges: Edges, others: Sequence[Parked]) -> bool:
    """Whether it stands off the roads, with room before and behind, and off the others."""
    length, width, _ = asset(one.asset).size
    long = rectangle(one.xy, one.yaw, length + 2 * CLEAR, 0.5 * width)
    points = np.concatenate([outline(one.corners), outline(long)])
    if edges.beyond(points, CLOSE).min() < CLOSE:
        return False
    return all(np.hypot(*(one.xy - other.xy)) > length for other in others)
