"""The line of a walk, and the stretches of it that lie on a road."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from datmo.arrays import F64, Bool
from sim.scene.roads import Road

KERB = 0.3  # a road begins this far beyond its edge [m]
Stretch = tuple[float, float]


def on_road(points: F64, roads: Sequence[Road]) -> Bool:
    """Which points (n, 2) [m, world] lie on a road, its kerb included."""
    found = np.zeros(len(points), bool)
    for road in roads:
        found |= cKDTree(road.centerline).query(points)[0] < road.width / 2 + KERB
    return found


@dataclass(frozen=True, eq=False)
class Line:
    """From `start` to `goal` (2,) [m, world]; walked there (way 1) and back (way -1)."""

    start: F64
    goal: F64

    @cached_property
    def length(self) -> float:
        """[m]."""
        return float(np.hypot(*(self.goal - self.start)))

    @cached_property
    def _unit(self) -> F64:
        return np.asarray((self.goal - self.start) / max(self.length, 1e-9))

    def ahead(self, way: int) -> F64:
        """Unit vector (2,) of the way."""
        return way * self._unit

    @cached_property
    def left(self) -> F64:
        """Unit vector (2,) to the left of the way there."""
        x, y = self.ahead(1)
        return np.array([-y, x])

    def along(self, xy: F64, way: int) -> float:
        """How far a point (2,) is along the way [m]."""
        return float(((xy - (self.start if way > 0 else self.goal)) * self.ahead(way)).sum())

    def at(self, along: float, aside: float, way: int) -> F64:
        """The point (2,) so far along the way, and so far to the left of the way there [m]."""
        begin = self.start if way > 0 else self.goal
        return np.asarray(begin + along * self.ahead(way) + aside * self.left)

    def crossings(self, roads: Sequence[Road], asides: Sequence[float]) -> list[Stretch]:
        """Stretches of the way there [m] on which a line `asides` of it lies on a road."""
        s = np.arange(0.0, self.length, 0.1)
        points = self.start + s[:, None] * self.ahead(1)
        on = np.zeros(len(s) + 2, bool)
        for aside in asides:
            on[1:-1] |= on_road(points + aside * self.left, roads)
        flips = np.flatnonzero(on[1:] != on[:-1])
        return [(0.1 * float(a), 0.1 * float(b)) for a, b in zip(flips[::2], flips[1::2], strict=True)]

    def stretches(self, crossings: Sequence[Stretch], way: int) -> list[Stretch]:
        """Stretches in the order of the way."""
        if way > 0:
            return list(crossings)
        return [(self.length - b, self.length - a) for a, b in reversed(crossings)]
