"""A polar occupancy grid whose cells grow with range.

Rings of cells around the sensor: up to a radius all are `cell` long, then each is longer than the
one before by a constant factor. Every ring has as many columns as fit its own circumference, so
cells are near to square close by and follow the spacing of the returns far away.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F64, I32, I64, Array, Bool
from datmo.clusters.config import ClusterConfig


@dataclass(frozen=True)
class PolarGrid:
    """Layout of the cells.

    Attributes:
        edges: (rings + 1,) radii of the ring edges [m].
        columns: (rings,) cells in each ring, counter-clockwise from azimuth -pi.
        first: (rings,) flat index of each ring's first cell.
    """

    edges: F64
    columns: I64
    first: I64

    @property
    def size(self) -> int:
        """Number of cells."""
        return int(self.columns.sum())

    def locate(self, points: Array, taken: Bool) -> I32:
        """Flat index of the cell of each point (n, 3) [m, sensor], -1 where it has none.

        Points that are not `taken`, out of range or not finite have none.
        """
        return np.asarray(_locate(points, taken, self.edges, self.columns, self.first))


def polar_grid(config: ClusterConfig) -> PolarGrid:
    """The grid of a configuration: cells max(cell, growth_along r) long, max(cell, growth_across r) wide."""
    edges = [0.0]
    while edges[-1] < config.max_range:
        edges.append(edges[-1] + max(config.cell, config.growth_along * edges[-1]))
    edges[-1] = config.max_range
    radii = np.array(edges)
    middle = (radii[1:] + radii[:-1]) / 2
    width = np.maximum(config.cell, config.growth_across * middle)
    columns = np.maximum(2 * np.pi * middle / width, 1).astype(np.int64)
    return PolarGrid(radii, columns, np.cumsum(columns) - columns)


@njit(cache=True, nogil=True)
def _locate(points: Array, taken: Bool, edges: F64, columns: I64, first: I64) -> I32:
    n = len(points)
    flat = np.full(n, -1, np.int32)
    for i in range(n):
        if not (taken[i] and np.isfinite(points[i, 2])):
            continue
        x, y = float(points[i, 0]), float(points[i, 1])
        r = np.sqrt(x * x + y * y)
        if not r < edges[-1]:
            continue
        ring = np.searchsorted(edges, r, side="right") - 1
        turn = (np.arctan2(y, x) + np.pi) / (2 * np.pi)
        flat[i] = first[ring] + min(int(turn * columns[ring]), columns[ring] - 1)
    return flat
