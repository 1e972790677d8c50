"""Which points are ground: near the surface by range and slope, nearer at the feet of obstacles."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, I32, I64, Bool
from datmo.ground.grid import Located

FOOT_LOW, FOOT_HIGH, FOOT_CELLS = 0.3, 2.5, 2
UNITS = 1e6
POINTS = 4.0  # of a cell, as its mean's noise reckons: the true number would make copies matter


@dataclass(frozen=True)
class LimitRules:
    """ζ_r at the sensor [m], its growth with range [m/m] and slope [m], its most [m], how much
    larger it is below the ground, the share kept near feet of obstacles, and its least in stds of
    an observation."""

    start: float
    by_range: float
    by_slope: float
    most: float
    below: float
    foot: float
    by_noise: float


@numba.njit(cache=True, nogil=True)
def foot_cells(e: F64, cell: I32, M: int, N: int) -> Bool:
    """Cells (M, N) at the feet of obstacles: of the 3 x 3 about them, at least two hold points
    0.3 to 2.5 m over the ground.

    Args:
        e: (n,) height of each point over the surface [m]. cell: (n,).
    """
    held = np.zeros(M * N, np.bool_)
    for i in range(len(e)):
        if FOOT_LOW < e[i] < FOOT_HIGH and cell[i] >= 0:
            held[cell[i]] = True
    has = held.reshape(M, N)
    foot, count = np.zeros((M, N), np.bool_), np.zeros(N + 2, np.int64)
    for m in range(M):
        before, after = has[m - 1 if m > 0 else M - 1], has[m + 1 if m + 1 < M else 0]
        for b in range(N):
            count[b + 1] = before[b] + has[m, b] + after[b]
        for b in range(N):
            foot[m, b] = count[b] + count[b + 1] + count[b + 2] >= FOOT_CELLS
    return foot


@numba.njit(cache=True, nogil=True)
def near_surface(e: F64, cell: I32, band: F64) -> Bool:
    """Ground (n,) where e is within the lowest and highest of the point's cell, band (M * N, 2) [m]."""
    out = np.zeros(len(e), np.bool_)
    for i in range(len(e)):
        c = cell[i]
        out[i] = c >= 0 and band[c, 0] <= e[i] <= band[c, 1]
    return out


@dataclass(frozen=True)
class CellMeans:
    """Means of the ground points of each cell, (M, N) arrays; without any the middle of the cell, at 0.

    Attributes:
        use: whether there are any. over: height over the surface [m]. r: range [m]. azimuth: in segments.
        noise: variance of `over` [m²], by the scatter within cells of a range and the number of points.
    """

    use: Bool
    over: F64
    r: F64
    azimuth: F64
    noise: F64


@numba.njit(cache=True, nogil=True)
def _cell_sums(e: F64, azimuth: F64, radius: F64, cell: I32, ground: Bool, cells: int) -> I64:
    """(cells, 5): number, Σ height, Σ height², Σ range and Σ azimuth of each cell's ground points.

    In whole micrometres (square millimetres; millionths of a segment): exact, so no order of the
    points decides.
    """
    out = np.zeros((cells, 5), np.int64)
    for i in range(len(e)):
        if ground[i]:
            at = out[cell[i]]
            at[0] += 1
            at[1] += np.int64(np.rint(e[i] * UNITS))
            at[2] += np.int64(np.rint(e[i] * e[i] * UNITS))
            at[3] += np.int64(np.rint(radius[i] * UNITS))
            at[4] += np.int64(np.rint((azimuth[i] - int(azimuth[i])) * UNITS))
    return out


def cell_means(located: Located, e: F64, ground: Bool, least_noise: float) -> CellMeans:
    """The means of the cells' ground points.

    Args:
        e: (n,) height over the surface [m]. ground: (n,). least_noise: variance of a mean's error [m²].
    """
    grid = located.grid
    M, N = grid.shape
    arrays = (e, located.azimuth, located.radius, located.cell, ground)
    means = _means(_cell_sums(*arrays, M * N).reshape(M, N, 5), grid.centers, least_noise)
    return CellMeans(means[0] > 0, *means[1:])


@numba.njit(cache=True, nogil=True)
def _means(sums: I64, centers: F64, least_noise: float) -> F64:
    """(5, M, N): number, and the columns of `CellMeans`, from `_cell_sums` (M, N, 5)."""
    M, N, _ = sums.shape
    out, scatter, free = np.zeros((5, M, N)), np.zeros(N), np.zeros(N)
    number, over, r, azimuth, noise = out
    for m in range(M):
        for b in range(N):
            n, r[m, b], azimuth[m, b] = sums[m, b, 0], centers[b], m + 0.5
            if n > 0:
                number[m, b], share = n, 1 / (UNITS * n)
                over[m, b], r[m, b] = sums[m, b, 1] * share, sums[m, b, 3] * share
                azimuth[m, b] = m + sums[m, b, 4] * share
                # Scatter within cells of one bin: each cell has few points, a ring of cells has many.
                scatter[b] += max(sums[m, b, 2] * share - over[m, b] ** 2, 0.0) * n
                free[b] += n
    for m in range(M):
        for b in range(N):
            noise[m, b] = scatter[b] / max(free[b], 1.0) / POINTS + least_noise
    return out


@numba.njit(cache=True, nogil=True)
def _limits(
    mean: F64,
    noise: F64,
    nodes: F64,
    start: float,
    by_range: float,
    by_slope: float,
    most: float,
    by_noise: float,
) -> tuple[F64, F64]:
    M, N = len(mean), len(nodes) - 2
    out, rough, width = np.empty((M, N)), np.empty((M, N)), 4 * np.pi / M
    for m in range(M):
        before, after = mean[m - 1 if m > 0 else M - 1], mean[m + 1 if m + 1 < M else 0]
        for b in range(N):
            along = (mean[m, b + 2] - mean[m, b]) / (nodes[b + 2] - nodes[b])
            across = (after[b + 1] - before[b + 1]) / (width * nodes[b + 1])
            slope = np.sqrt(along * along + across * across)
            out[m, b] = min(start + by_range * nodes[b + 1] + by_slope * slope, most)
            rough[m, b] = by_noise * np.sqrt(noise[m, b + 1])
    return out, rough


def limits(height: F64, noise: F64, nodes: F64, rules: LimitRules) -> tuple[F64, F64]:
    """Thresholds (M, N) of each cell [m]: ζ_r, and what rough ground scatters by itself.

    ζ_r is that at the sensor + with range + with the slope of the surface over its plane, up to the
    most; the second is a multiple of the std of an observation about the surface (as Z-L-I has it).

    Args:
        height: (M, N + 2) of the surface over its plane at the nodes (N + 2,) [m]. noise: (M, N + 2)
        variance of an observation about it [m²].
    """
    numbers = (rules.start, rules.by_range, rules.by_slope, rules.most, rules.by_noise)
    return _limits(height, noise, nodes, *numbers)


def label_points(over: F64, cell: I32, limit: F64, rough: F64, rules: LimitRules) -> Bool:
    """Which points (n,) are ground: within the limits of their cell, less at feet of obstacles.

    Args:
        over: (n,) height over the surface [m]. cell: (n,), -1 never ground. limit, rough: of `limits`.
    """
    foot = foot_cells(over, cell, *limit.shape)
    above = np.maximum(np.where(foot, rules.foot * limit, limit), rough)
    band = np.stack([-rules.below * limit, above], -1).reshape(-1, 2)
    # Too short for handing it to threads to pay.
    return np.asarray(near_surface(over, cell, band))
