"""The polar grid map (3.1-3.5): M segments of equal angle, N bins that widen."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F32, F64, I32, Bool

OUTSIDE = -1
TURN = 2 * np.pi


@dataclass(frozen=True)
class PolarGrid:
    """The grid's geometry; angles from +x, ranges in the x-y plane of the sensor.

    Attributes:
        segments: M. edges: (N + 1,) of `datmo.bins` [m]; a bin is [edge_b, edge_b+1).
    """

    segments: int
    edges: F64

    @property
    def shape(self) -> tuple[int, int]:
        """(M, N)."""
        return self.segments, len(self.edges) - 1

    @property
    def centers(self) -> F64:
        """(N,) middles of the bins [m]."""
        return np.asarray((self.edges[1:] + self.edges[:-1]) / 2)

    @property
    def nodes(self) -> F64:
        """(N + 2,) 0, the middles of the bins, the outer edge [m]."""
        return np.concatenate([[0.0], self.centers, self.edges[-1:]])

    @property
    def angles(self) -> F64:
        """(M,) middles of the segments [rad]."""
        return np.asarray((np.arange(self.segments) + 0.5) * (TURN / self.segments))

    @property
    def areas(self) -> F64:
        """(N,) area of a cell of each bin [m²]."""
        return np.asarray(np.diff(self.edges**2) * (np.pi / self.segments))

    def xy(self, r: F64) -> F64:
        """Places (M * K, 2) at ranges (M, K) or (K,) on the middle line of each segment [m]."""
        r = np.broadcast_to(r, (self.segments, np.shape(r)[-1]))
        return np.stack([r * np.cos(self.angles)[:, None], r * np.sin(self.angles)[:, None]], -1).reshape(
            -1, 2
        )


@numba.njit(cache=True, nogil=True)
def locate(points: F32, keep: Bool, edges: F64, segments: int) -> tuple[I32, F64, F64]:
    """Cell of each point, azimuth in segments [0, M) and range.

    Args:
        points: (n, 3) [m, sensor]. keep: (n,). edges: (N + 1,) [m].

    Returns:
        cell (n,) = segment * N + bin, -1 for points that are not kept, not finite, outside the
        edges or further than the last above or below the sensor; azimuth (n,) from +x in units of a
        segment; range (n,) [m]. Azimuth and range are NaN where x or y is not finite.
    """
    n, bins = len(points), len(edges) - 1
    cell, azimuth, radius = np.full(n, OUTSIDE, np.int32), np.full(n, np.nan), np.full(n, np.nan)
    for i in range(n):
        x, y, z = np.float64(points[i, 0]), np.float64(points[i, 1]), points[i, 2]
        if not (np.isfinite(x) and np.isfinite(y)):
            continue
        turn = np.arctan2(y, x) / TURN
        s = (turn + 1.0 if turn < 0 else turn) * segments
        azimuth[i] = s if s < segments else 0.0
        radius[i] = np.sqrt(x * x + y * y)
        if keep[i] and edges[0] <= radius[i] < edges[bins] and abs(z) < edges[bins]:
            b = np.searchsorted(edges, radius[i], side="right") - 1
            cell[i] = int(azimuth[i]) * bins + b
    return cell, azimuth, radius


@numba.njit(cache=True, nogil=True)
def _before(points: F32, za: float, a: int, zb: float, b: int) -> bool:
    """Whether point a comes before b by height, then x, then y: no order of rows decides."""
    if za != zb:
        return za < zb
    if points[a, 0] != points[b, 0]:
        return bool(points[a, 0] < points[b, 0])
    return bool(points[a, 1] < points[b, 1])


@numba.njit(cache=True, nogil=True)
def lowest(points: F32, cell: I32, plane: F64, cells: int, multipath: float) -> tuple[I32, F64]:
    """The ground candidate of each cell and how far its points reach above it.

    The candidate is the point lowest above `plane`, or the second lowest where that lies more than
    `multipath` higher: a return from below the ground is a mirror image.

    Args:
        points: (n, 3). cell: (n,). plane: (3,) z = a x + b y + c.

    Returns:
        index (cells,) row of the candidate, -1 where the cell is empty; extent (cells,) height of
        the cell's highest point above its candidate [m].
    """
    first, second = np.full(cells, -1, np.int32), np.full(cells, -1, np.int32)
    low, after, high = np.full(cells, np.inf), np.full(cells, np.inf), np.full(cells, -np.inf)
    for i in range(len(points)):
        c = cell[i]
        if c < 0:
            continue
        z = points[i, 2] - plane[0] * points[i, 0] - plane[1] * points[i, 1] - plane[2]
        high[c] = max(high[c], z)
        if first[c] < 0 or _before(points, z, i, low[c], first[c]):
            if first[c] >= 0 and low[c] > z:
                after[c], second[c] = low[c], first[c]
            low[c], first[c] = z, i
        elif z > low[c] and (second[c] < 0 or _before(points, z, i, after[c], second[c])):
            after[c], second[c] = z, i
    for c in range(cells):
        if second[c] >= 0 and after[c] - low[c] > multipath:
            first[c], low[c] = second[c], after[c]
    return first, high - low


@dataclass(frozen=True)
class Candidates:
    """The lowest point of each cell, (M, N) arrays; values mean nothing where `present` is False.

    Attributes:
        present: whether the cell holds a point. xyz: (M, N, 3) the point [m, sensor].
        r: its range, the bin's middle where empty [m]. height: over the plane [m].
        extent: height of the cell's highest point above it [m].
    """

    present: Bool
    xyz: F64
    r: F64
    height: F64
    extent: F64


def candidates(
    points: F32, cell: I32, radius: F64, plane: F64, grid: PolarGrid, multipath: float
) -> Candidates:
    """The ground candidates of all cells over `plane` (3,); see `lowest`."""
    M, N = grid.shape
    index, extent = lowest(points, cell, plane, M * N, multipath)
    present = index >= 0
    xyz, r = np.zeros((M * N, 3)), np.tile(grid.centers, M)
    xyz[present], r[present] = points[index[present]], radius[index[present]]
    height = np.where(present, xyz[:, 2] - plane[0] * xyz[:, 0] - plane[1] * xyz[:, 1] - plane[2], 0)
    extent = np.where(present, extent, 0)
    shape = (M, N)
    return Candidates(
        present.reshape(shape),
        xyz.reshape(M, N, 3),
        r.reshape(shape),
        height.reshape(shape),
        extent.reshape(shape),
    )
