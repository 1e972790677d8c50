"""What a vehicle looks like, where it may appear, and the state traffic reports of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, Bool
from datmo.errors import SimulationError, nearest
from datmo.messages import Kind
from sim.scene.assets import asset, keys
from sim.scene.course import Key, Lane

FLEET = (*keys(Kind.CAR)[:4], *keys(Kind.VAN))
"""Meshes of traffic where nothing is said of its mix, each as likely as the others."""
DRIVEN = {
    "car": Kind.CAR,
    "van": Kind.VAN,
    "truck": Kind.TRUCK,
    "bus": Kind.BUS,
    "motorcycle": Kind.MOTORCYCLE,
    "bicycle": Kind.BICYCLE,
}
"""What may be named in a mix of traffic."""


@dataclass(frozen=True)
class Body:
    """A mesh by its key, and the size of its box [m]."""

    asset: str
    kind: Kind
    length: float
    width: float
    height: float = 0.0


@dataclass(frozen=True, eq=False)
class State:
    """One actor at one time.

    Attributes:
        xy: (2,) [m, world]. velocity: (2,) [m/s, world].
        yaw: [rad, world], not wrapped. yaw_rate: [rad/s].
    """

    id: int
    body: Body
    xy: F64
    yaw: float
    velocity: F64
    yaw_rate: float = 0.0


def body(key: str) -> Body:
    """The body of a mesh."""
    made = asset(key)
    return Body(key, made.kind, *made.size)


def fleet(mix: Mapping[str, float]) -> tuple[tuple[str, ...], F64]:
    """Meshes of a mix of traffic and how likely each is: a kind's share, spread evenly over its variants.

    Args:
        mix: shares of kinds by their names in DRIVEN; they need not add up to 1.

    Raises:
        SimulationError: an unknown kind, a share that is negative or not finite, or nothing above 0.
    """
    for name, share in mix.items():
        if name not in DRIVEN:
            raise SimulationError(f"{name!r} does not drive; {nearest(name, DRIVEN)}")
        if not (np.isfinite(share) and share >= 0):
            raise SimulationError(f"the share of {name} is {share}; it must be finite and 0 or more")
    total = sum(mix.values())
    if not total > 0:
        raise SimulationError(f"no kind of the mix {dict(mix)} has a share above 0; give one")
    made: list[str] = []
    weights: list[float] = []
    for name, share in mix.items():
        variants = keys(DRIVEN[name])
        made += variants
        weights += [share / total / len(variants)] * len(variants)
    return tuple(made), np.array(weights)


class Places:
    """Every metre of every lane outside the crossings: where a vehicle may appear.

    Attributes:
        keys: of the lanes. lane: (m,) index into keys. arc: (m,) along the lane [m].
        xy: (m, 2) [m, world]. direction: (m, 2) unit vectors.
    """

    def __init__(self, lanes: Mapping[Key, Lane]) -> None:
        free = [lane for lane in lanes.values() if not lane.crossing]
        self.keys = [lane.key for lane in free]
        arcs = [np.arange(4.0, lane.length - 4.0) for lane in free]
        self.lane = np.repeat(np.arange(len(free)), [len(a) for a in arcs])
        self.arc = np.concatenate([np.zeros(0), *arcs])
        points = [lane.at(a) for lane, a in zip(free, arcs, strict=True)]
        after = [lane.at(a + 0.5) for lane, a in zip(free, arcs, strict=True)]
        self.xy = np.concatenate([np.zeros((0, 2)), *points])
        step = np.concatenate([np.zeros((0, 2)), *after]) - self.xy
        self.direction = step / np.hypot(step[:, 0], step[:, 1])[:, None]

    def within(self, centre: F64, low: float, high: float) -> Bool:
        """Places (m,) whose distance from `centre` (2,) lies between `low` and `high` [m]."""
        d = np.hypot(*(self.xy - centre).T)
        return np.asarray((d >= low) & (d <= high))

    def towards(self, centre: F64) -> Bool:
        """Places (m,) from which a vehicle comes nearer to `centre` (2,)."""
        return np.asarray(np.einsum("ij,ij->i", self.direction, centre - self.xy) > 0)

    def on(self, key: Key, low: float, high: float) -> Bool:
        """Places (m,) on a lane between two arc lengths [m]."""
        if key not in self.keys:
            return np.zeros(len(self.arc), bool)
        return np.asarray((self.lane == self.keys.index(key)) & (self.arc >= low) & (self.arc <= high))
