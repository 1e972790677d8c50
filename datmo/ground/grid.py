"""The polar grid map (3.1-3.5): M segments of equal angle, N bins that widen."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np

from datmo.arrays import F32, F64, I32, I64, Bool
from datmo.threads import blocks, over_rows, spread

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

    @cached_property
    def table(self) -> I64:
        """Of `bin_table`."""
        return bin_table(self.edges)

    @cached_property
    def middle(self) -> tuple[F64, F64, F64, F64, F64]:
        """x, y, z = 0, azimuth [segments] and range (M * N,) of the middles of all cells."""
        x, y = self.xy(self.centers).T
        azimuth = np.repeat(np.arange(self.segments) + 0.5, len(self.centers))
        return x, y, np.zeros(len(x)), azimuth, np.tile(self.centers, self.segments)

    @cached_property
    def node_places(self) -> tuple[F64, F64]:
        """Azimuth [segments] and range [m] of every node, (M * Q,) each."""
        nodes = self.nodes
        return np.repeat(np.arange(self.segments) + 0.5, len(nodes)), np.tile(nodes, self.segments)

    def xy(self, r: F64) -> F64:
        """Places (M * K, 2) at ranges (M, K) or (K,) on the middle line of each segment [m]."""
        r = np.broadcast_to(r, (self.segments, np.shape(r)[-1]))
        return np.stack([r * np.cos(self.angles)[:, None], r * np.sin(self.angles)[:, None]], -1).reshape(
            -1, 2
        )


# atan(t), 0 <= t <= 1, to 2e-8: Abramowitz and Stegun, Handbook of Mathematical Functions (1964), 4.4.49.
ATAN = (1.0, -0.3333314528, 0.1999355085, -0.1420889944, 0.1065626393, -0.0752896400, 0.0429096138)
ATAN_LAST = (-0.0161657367, 0.0028662257)
STEPS = 32.0  # of the table of bins, a metre


def bin_table(edges: F64) -> I64:
    """The bin that holds each 1/32 m of range from 0 on, or the one before the bin that does."""
    starts = np.arange(int(edges[-1] * STEPS) + 2) / STEPS
    return np.clip(np.searchsorted(edges, starts, side="right") - 1, 0, len(edges) - 2).astype(np.int64)


@numba.njit(cache=True, nogil=True)
def turn_of(x: float, y: float) -> float:
    """Azimuth of (x, y) from +x as a share of a turn, in [0, 1)."""
    a, b = abs(x), abs(y)
    steep = b > a
    t = a / b if steep else (b / a if a > 0.0 else 0.0)
    u = t * t
    tail = ATAN[6] + u * (ATAN_LAST[0] + u * ATAN_LAST[1])
    angle = t * (
        ATAN[0] + u * (ATAN[1] + u * (ATAN[2] + u * (ATAN[3] + u * (ATAN[4] + u * (ATAN[5] + u * tail)))))
    )
    share = angle / TURN
    share = 0.25 - share if steep else share
    share = 0.5 - share if x < 0.0 else share
    share = 1.0 - share if y < 0.0 else share
    return share if share < 1.0 else 0.0


@numba.njit(cache=True, nogil=True)
def locate(
    points: F32, keep: Bool, cell: I32, azimuth: F64, radius: F64, edges: F64, table: I64, segments: int
) -> None:
    """Cell of each point, azimuth in segments [0, M) and range, written to `cell`, `azimuth`, `radius`.

    A cell is segment * N + bin, -1 for points that are not kept, not finite, outside the edges or
    further than the last above or below the sensor; azimuth is from +x in units of a segment. Azimuth and
    range are NaN where x or y is not finite.

    Args:
        points: (n, 3) [m, sensor]. keep: (n,). edges: (N + 1,) [m]. table: of `bin_table`.
    """
    bins = len(edges) - 1
    near, far = edges[0], edges[bins]
    for i in range(len(points)):
        x, y, z = np.float64(points[i, 0]), np.float64(points[i, 1]), points[i, 2]
        cell[i] = OUTSIDE
        if not (np.isfinite(x) and np.isfinite(y)):
            azimuth[i] = radius[i] = np.nan
            continue
        azimuth[i] = turn_of(x, y) * segments
        r = np.sqrt(x * x + y * y)
        radius[i] = r
        if keep[i] and near <= r < far and abs(z) < far:
            b = table[int(r * STEPS)]
            while r >= edges[b + 1]:
                b += 1
            cell[i] = int(azimuth[i]) * bins + b


@numba.njit(cache=True, nogil=True)
def _before(points: F32, a: int, b: int) -> bool:
    """Whether point a, as low as b, comes before it by x, then y: no order of rows decides."""
    if points[a, 0] != points[b, 0]:
        return bool(points[a, 0] < points[b, 0])
    return bool(points[a, 1] < points[b, 1])


@numba.njit(cache=True, nogil=True)
def _insert(points: F32, i: int, c: int, first: I32, second: I32, low: F32, after: F32) -> None:
    """Take point i among the lowest point of cell c and the lowest that lies higher than that; low and
    after are their z, infinite without one."""
    z = points[i, 2]
    if z < low[c]:
        second[c], after[c] = first[c], low[c]
        first[c], low[c] = i, z
    elif z == low[c]:
        if _before(points, i, first[c]):
            first[c] = i
    elif z < after[c] or (z == after[c] and _before(points, i, second[c])):
        second[c], after[c] = i, z


@numba.njit(cache=True, nogil=True)
def _lowest(
    points: F32, cell: I32, start: int, stop: int, first: I32, second: I32, low: F32, after: F32, high: F32
) -> None:
    """Lowest and second lowest point of each cell among rows start..stop-1, and the highest z."""
    first[:], second[:], low[:], after[:], high[:] = -1, -1, np.inf, np.inf, -np.inf
    for i in range(start, stop):
        c = cell[i]
        if c >= 0:
            z = points[i, 2]
            if z > high[c]:
                high[c] = z
            if z < low[c]:  # the common cases of `_insert`, whose call costs more than they do
                second[c], after[c] = first[c], low[c]
                first[c], low[c] = i, z
            elif low[c] < z < after[c]:
                second[c], after[c] = i, z
            elif z <= after[c]:
                _insert(points, i, c, first, second, low, after)


@numba.njit(cache=True, nogil=True)
def _merge(points: F32, rows: I32, heights: F32, multipath: float) -> tuple[I32, F64]:
    """The candidate (cells,) of blocks, -1 where empty, and the height of the highest point above it [m].

    It is the second lowest where that lies more than `multipath` higher: a return from below the ground
    is a mirror image.

    Args:
        rows: (k, 2, cells) lowest and second lowest. heights: (k, 3, cells) their z and the highest.
    """
    first, second = rows[0]
    low, after, high = heights[0]
    for k in range(1, len(rows)):
        for c in range(len(first)):
            if rows[k, 0, c] < 0:
                continue
            if first[c] < 0:
                first[c], second[c] = rows[k, :, c]
                low[c], after[c], high[c] = heights[k, :, c]
                continue
            high[c] = max(high[c], heights[k, 2, c])
            for j in range(2):
                if rows[k, j, c] >= 0 and heights[k, j, c] <= after[c]:
                    _insert(points, rows[k, j, c], c, first, second, low, after)
    for c in range(len(first)):
        if second[c] >= 0 and after[c] - low[c] > multipath:
            first[c], low[c] = second[c], after[c]
        high[c] = high[c] - low[c] if first[c] >= 0 else 0.0
    return first, high.astype(np.float64)


@numba.njit(cache=True, nogil=True)
def _place(points: F32, azimuth: F64, radius: F64, index: I32, columns: F64) -> None:
    """x, y, z, azimuth and range of the points `index`, written to `columns` (5, cells)."""
    x, y, z, turn, r = columns
    for c in range(len(index)):
        i = index[c]
        if i >= 0:
            x[c], y[c], z[c] = points[i]
            turn[c], r[c] = azimuth[i], radius[i]


@dataclass(frozen=True)
class Candidates:
    """The lowest point of each cell, (M, N) arrays; where none is present the cell's middle, at height 0.

    Attributes:
        present: whether the cell holds a point. x, y, z: of the point [m, sensor].
        azimuth: in segments. r: range [m]. extent: height of the cell's highest point above it [m].
    """

    present: Bool
    x: F64
    y: F64
    z: F64
    azimuth: F64
    r: F64
    extent: F64

    def above(self, plane: F64) -> F64:
        """Height (M, N) over the plane z = a x + b y + c [m]; 0 where not present."""
        return np.where(self.present, self.z - plane[0] * self.x - plane[1] * self.y - plane[2], 0.0)


class Located:
    """The points of one scan in the cells of a grid.

    Attributes:
        points: (n, 3) [m, sensor]. cell: (n,), -1 outside. azimuth: (n,) in segments. radius: (n,) [m].
    """

    def __init__(self, points: F32, keep: Bool, grid: PolarGrid) -> None:
        n = len(points)
        self.points, self.grid = points, grid
        self.cell, self.azimuth, self.radius = np.empty(n, np.int32), np.empty(n), np.empty(n)
        arrays = (points, keep, self.cell, self.azimuth, self.radius)
        over_rows(locate, arrays, (grid.edges, grid.table, grid.segments))

    def candidates(self, multipath: float) -> Candidates:
        """The ground candidates of all cells, see `_merge`."""
        M, N = self.grid.shape
        halves = blocks(len(self.points), 2)
        rows = np.empty((len(halves), 2, M * N), np.int32)
        heights = np.empty((len(halves), 3, M * N), np.float32)

        def lowest(k: int) -> None:
            _lowest(self.points, self.cell, halves[k].start, halves[k].stop, *rows[k], *heights[k])

        spread(lowest, range(len(halves)))
        index, extent = _merge(self.points, rows, heights, multipath)
        columns = np.array(self.grid.middle)
        _place(self.points, self.azimuth, self.radius, index, columns)
        x, y, z, azimuth, r = columns.reshape(5, M, N)
        return Candidates((index >= 0).reshape(M, N), x, y, z, azimuth, r, extent.reshape(M, N))
