"""A road as the terrain needs it: where it runs and how wide it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F64
from datmo.errors import SimulationError


@njit(cache=True, nogil=True)
def _lower(line: F64, half: float, reach: float, x0: float, y0: float, cell: float, out: F64) -> None:
    """Lower `out` (ny, nx) to the distance beyond the road's edge, wherever that is under `reach`."""
    ny, nx = out.shape
    room = half + reach
    for s in range(len(line) - 1):
        ax, ay = line[s]
        bx, by = line[s + 1]
        ex, ey = bx - ax, by - ay
        square = max(ex * ex + ey * ey, 1e-18)
        i0, i1 = (min(ax, bx) - room - x0) / cell, (max(ax, bx) + room - x0) / cell
        j0, j1 = (min(ay, by) - room - y0) / cell, (max(ay, by) + room - y0) / cell
        for j in range(max(int(j0), 0), min(int(j1) + 2, ny)):
            for i in range(max(int(i0), 0), min(int(i1) + 2, nx)):
                px, py = x0 + i * cell - ax, y0 + j * cell - ay
                t = min(max((px * ex + py * ey) / square, 0.0), 1.0)
                beyond = np.sqrt((px - t * ex) ** 2 + (py - t * ey) ** 2) - half
                out[j, i] = min(out[j, i], beyond)


def beyond_edge(
    roads: Sequence[Road], shape: tuple[int, int], corner: tuple[float, float], cell: float, reach: float
) -> F64:
    """Distances (ny, nx) [m] beyond the edge of the nearest road, at most `reach`, negative on a road.

    Args:
        shape: rows (y) and columns (x) of the grid. corner: x, y of its first node [m, world].
        cell: its spacing [m].
    """
    beyond = np.full(shape, float(reach))
    for road in roads:
        _lower(road.centerline, road.width / 2, float(reach), corner[0], corner[1], cell, beyond)
    return beyond


@dataclass(frozen=True, eq=False)
class Road:
    """A strip of paved ground.

    Args:
        centerline: (m, 2) with m >= 2 [m, world].
        width: the whole width of the strip [m].

    Raises:
        SimulationError: the centreline is no finite polyline, or the width is not positive.
    """

    centerline: F64
    width: float

    def __post_init__(self) -> None:
        line = np.ascontiguousarray(self.centerline, float)
        if line.ndim != 2 or line.shape[1] != 2 or len(line) < 2 or not np.isfinite(line).all():
            raise SimulationError(
                f"the centreline of a road has shape {line.shape}; it must be (m >= 2, 2) and finite; "
                "give at least two way-points (x, y)"
            )
        if not (np.isfinite(self.width) and self.width > 0):
            raise SimulationError(f"the width of a road is {self.width} m; it must be above 0; widen it")
        object.__setattr__(self, "centerline", line)
