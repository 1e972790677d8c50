"""Which points are ground: near the surface by range and slope, nearer at the feet of obstacles."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, I32, I64, Bool
from datmo.ground.surface import PolarSurface

FOOT_LOW, FOOT_HIGH, FOOT_CELLS = 0.3, 2.5, 2
UNIT = 1e-6


@dataclass(frozen=True)
class LimitRules:
    """ζ_r at the sensor [m], its growth with range [m/m] and slope [m], its most [m], how much
    larger it is below the ground, and the share kept near feet of obstacles."""

    start: float
    by_range: float
    by_slope: float
    most: float
    below: float
    foot: float


@numba.njit(cache=True, nogil=True)
def foot_cells(e: F64, cell: I32, M: int, N: int) -> Bool:
    """Cells (M, N) at the feet of obstacles: of the 3 x 3 about them, at least two hold points
    0.3 to 2.5 m over the ground.

    Args:
        e: (n,) height of each point over the surface [m]. cell: (n,).
    """
    has = np.zeros((M, N), np.bool_)
    for i in range(len(e)):
        if cell[i] >= 0 and FOOT_LOW < e[i] < FOOT_HIGH:
            has.flat[cell[i]] = True
    foot = np.zeros((M, N), np.bool_)
    for m in range(M):
        for b in range(N):
            count = 0
            for o in range(m - 1, m + 2):
                for c in range(max(b - 1, 0), min(b + 2, N)):
                    count += has[o % M, c]
            foot[m, b] = count >= FOOT_CELLS
    return foot


@numba.njit(cache=True, nogil=True)
def near_surface(e: F64, cell: I32, above: F64, below: F64) -> Bool:
    """Ground (n,) where -below <= e <= above, both (M * N,) of the point's cell [m]."""
    out = np.zeros(len(e), np.bool_)
    for i in range(len(e)):
        if cell[i] >= 0:
            out[i] = -below[cell[i]] <= e[i] <= above[cell[i]]
    return out


@numba.njit(cache=True, nogil=True)
def cell_means(e: F64, radius: F64, cell: I32, ground: Bool, cells: int) -> tuple[I64, F64, F64]:
    """Number, mean height over the surface and mean range of the ground points of each cell.

    Summed in whole micrometres: exact, so no order of the points decides.
    """
    count, se, sr = np.zeros(cells, np.int64), np.zeros(cells, np.int64), np.zeros(cells, np.int64)
    for i in range(len(e)):
        c = cell[i]
        if c >= 0 and ground[i]:
            count[c] += 1
            se[c] += np.int64(np.rint(e[i] / UNIT))
            sr[c] += np.int64(np.rint(radius[i] / UNIT))
    some = np.maximum(count, 1)
    return count, se * UNIT / some, sr * UNIT / some


def limits(surface: PolarSurface, centers: F64, rules: LimitRules) -> F64:
    """Threshold ζ_r (M, N) of each cell [m]: at the sensor + with range + with the slope of the
    surface over its plane, up to the most.

    Args:
        centers: (N,) middles of the bins, `surface.nodes` without its ends [m].
    """
    along = np.gradient(surface.mean, surface.nodes, axis=1)[:, 1:-1]
    across = (np.roll(surface.mean, -1, 0) - np.roll(surface.mean, 1, 0))[:, 1:-1]
    slope = np.hypot(along, across / (4 * np.pi / len(surface.mean) * centers))
    return np.asarray(np.minimum(rules.start + rules.by_range * centers + rules.by_slope * slope, rules.most))


def label_points(over: F64, cell: I32, limit: F64, rules: LimitRules) -> Bool:
    """Which points (n,) are ground: within the limit of their cell, less at feet of obstacles.

    Args:
        over: (n,) height over the surface [m]. cell: (n,), -1 never ground. limit: (M, N) [m].
    """
    foot = foot_cells(over, cell, *limit.shape)
    near = np.where(foot, rules.foot * limit, limit).ravel()
    return np.asarray(near_surface(over, cell, near, limit.ravel() * rules.below))
