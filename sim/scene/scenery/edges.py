"""How far places are from the roads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from datmo.arrays import F64
from sim.scene.carriageways import offsets
from sim.scene.roads import Road


class Edges:
    """The edges of roads, asked for many places.

    Args:
        roads: any number.
    """

    def __init__(self, roads: Sequence[Road]) -> None:
        self._roads = tuple(roads)
        self._low = np.array([r.centerline.min(0) - r.width / 2 for r in roads]).reshape(-1, 2)
        self._high = np.array([r.centerline.max(0) + r.width / 2 for r in roads]).reshape(-1, 2)

    def beyond(self, points: F64, reach: float = np.inf) -> F64:
        """Distances (n,) of points (n, 2) beyond the nearest road's edge [m], at most `reach`; on one < 0."""
        nearest = np.full(len(points), reach)
        gap = np.maximum(np.maximum(self._low - points.max(0), points.min(0) - self._high), 0.0)
        for i in np.flatnonzero(np.hypot(gap[:, 0], gap[:, 1]) < reach):
            road = self._roads[i]
            nearest = np.minimum(nearest, offsets(road.centerline, points)[:, 0] - road.width / 2)
        return nearest
