"""The ground at any place: Gaussian processes of all segments, joined along azimuth."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F32, F64, I32, Bool
from datmo.ground.grid import Located
from datmo.messages import Surface
from datmo.messages.base import Message
from datmo.threads import over_rows

BEYOND = 0.1


@numba.njit(cache=True, nogil=True)
def _corner(nodes: F64, radius: float) -> tuple[int, float]:
    """Column left of `radius` and the share of the next one."""
    q = min(max(int(np.searchsorted(nodes, radius, side="right")) - 1, 0), len(nodes) - 2)
    return q, min((radius - nodes[q]) / (nodes[q + 1] - nodes[q]), 1.0)


@numba.njit(cache=True, nogil=True)
def _blend(s: float, q: int, t: float, table: F64) -> float:
    """Bilinear value at azimuth s [segments from the middle of the first] and share t past column q."""
    M = len(table)
    m = int(np.floor(s))
    f = s - m
    a, b = (m if m >= 0 else M - 1), (m + 1 if m + 1 < M else 0)
    low = (1 - t) * table[a, q] + t * table[a, q + 1]
    high = (1 - t) * table[b, q] + t * table[b, q + 1]
    return float((1 - f) * low + f * high)


@numba.njit(cache=True, nogil=True)
def interpolate(
    x: F64, y: F64, azimuth: F64, radius: F64, plane: F64, nodes: F64, table: F64, spread: F64
) -> tuple[F64, F64]:
    """Height and deviation (n,) at (x, y), whose azimuth [segments] and radius [m] are known.

    Bilinear in azimuth and radius; rows stand at the middle of their segment and close around. NaN
    where the azimuth is.
    """
    mean, std = np.full(len(x), np.nan), np.full(len(x), np.nan)
    for i in range(len(x)):
        if np.isnan(azimuth[i]):
            continue
        s = azimuth[i] - 0.5
        q, t = _corner(nodes, radius[i])
        mean[i] = _blend(s, q, t, table) + plane[0] * x[i] + plane[1] * y[i] + plane[2]
        std[i] = np.hypot(_blend(s, q, t, spread), BEYOND * max(radius[i] - nodes[-1], 0.0))
    return mean, std


@numba.njit(cache=True, nogil=True)
def over_points(
    points: F32,
    cell: I32,
    azimuth: F64,
    radius: F64,
    over: F64,
    std: F32,
    with_std: bool,
    plane: F64,
    nodes: F64,
    table: F64,
    spread: F64,
) -> None:
    """Height of each point over the surface and, if asked, its deviation [m], written to `over`, `std`."""
    # As `interpolate`, with `_blend` written out: a call with arrays costs as much as the rest.
    M, N, last = len(table), len(nodes) - 2, nodes[-1]
    slope_x, slope_y, level = plane
    inverse = 1 / np.diff(nodes)
    for i in range(len(points)):
        r, s = radius[i], azimuth[i]
        if np.isnan(s):
            over[i], std[i] = np.nan, np.nan
            continue
        if cell[i] >= 0:
            q = cell[i] - int(s) * N
            q += int(r >= nodes[q + 1])
        else:
            q = min(int(np.searchsorted(nodes, r, side="right")) - 1, N)
        t = min((r - nodes[q]) * inverse[q], 1.0)
        s += 0.5  # from the middle of the last segment
        b, f = int(s), s - int(s)
        a, b = (b - 1 if b > 0 else M - 1), (b if b < M else 0)
        low = (1 - t) * table[a, q] + t * table[a, q + 1]
        high = (1 - t) * table[b, q] + t * table[b, q + 1]
        height = slope_x * points[i, 0] + slope_y * points[i, 1] + level
        over[i] = points[i, 2] - height - low - f * (high - low)
        if with_std:
            low = (1 - f) * spread[a, q] + f * spread[b, q]
            low += t * ((1 - f) * spread[a, q + 1] + f * spread[b, q + 1] - low)
            std[i] = low if r <= last else np.hypot(low, BEYOND * (r - last))


@numba.njit(cache=True, nogil=True)
def at_cells(table: F64, nodes: F64, azimuth: F64, radius: F64) -> F64:
    """Bilinear value of table (M, Q) at one place in each cell, azimuths [segments] and radii (M, N) [m]."""
    out, inverse = np.empty_like(radius), 1 / np.diff(nodes)
    for m in range(len(table)):
        for b in range(radius.shape[1]):
            q = b + 1 if radius[m, b] >= nodes[b + 1] else b
            t = (radius[m, b] - nodes[q]) * inverse[q]
            out[m, b] = _blend(azimuth[m, b] - 0.5, q, t, table)
    return out


@numba.njit(cache=True, nogil=True)
def gaps(seen: Bool, bins: F64, nodes: F64) -> F64:
    """About how far (M, Q) each node is from the nearest seen cell, along range and arc [m].

    Args:
        seen: (M, N). bins: (N,) where the cells stand [m]. nodes: (Q,) [m].
    """
    M, Q = len(seen), len(nodes)
    gap, column, step = np.full((M, Q), np.inf), np.searchsorted(nodes, bins), np.diff(nodes)
    for m in range(M):
        row = gap[m]
        for b in range(len(bins)):
            if seen[m, b]:
                q = column[b]
                row[q] = min(row[q], abs(nodes[q] - bins[b]))
        for q in range(1, Q):
            row[q] = min(row[q], row[q - 1] + step[q - 1])
        for q in range(Q - 2, -1, -1):
            row[q] = min(row[q], row[q + 1] + step[q])
    arc = 2 * np.pi / M * nodes
    for way in (1, -1):
        for k in range(2 * M):
            m = k % M if way > 0 else M - 1 - k % M
            before = m - way if 0 <= m - way < M else (M - 1 if way > 0 else 0)
            for q in range(Q):
                gap[m, q] = min(gap[m, q], gap[before, q] + arc[q])
    return gap


@dataclass(frozen=True, eq=False)
class PolarSurface(Message, Surface):
    """Heights over a plane on polar nodes, bilinear between them, continuous everywhere.

    Attributes:
        plane: (3,) z = a x + b y + c [m, sensor].
        nodes: (Q,) ranges [m], the first is 0, increasing.
        mean: (M, Q) height over the plane at the middle of each segment [m].
        std: (M, Q) standard deviation of the latent height [m]; beyond the last node it grows by a
            tenth of the distance.
    """

    plane: F64
    nodes: F64
    mean: F64
    std: F64

    def __post_init__(self) -> None:
        self._set("plane", (3,), np.float64)
        self._set("nodes", (None,), np.float64)
        self._set("mean", (None, len(self.nodes)), np.float64)
        self._set("std", (len(self.mean), len(self.nodes)), np.float64)

    def __call__(self, xy: F64) -> tuple[F64, F64]:
        """See `Surface`. NaN where a coordinate is not finite."""
        xy = np.asarray(xy, float).reshape(-1, 2)
        x, y = np.where(np.isfinite(xy).all(1, keepdims=True), xy, np.nan).T
        azimuth = np.arctan2(y, x) / (2 * np.pi) % 1.0 * len(self.mean)
        return self.at(x, y, azimuth, np.hypot(x, y))

    def at(self, x: F64, y: F64, azimuth: F64, radius: F64) -> tuple[F64, F64]:
        """As the call, for places whose azimuth [segments] and radius [m] are known."""
        return interpolate(x, y, azimuth, radius, self.plane, self.nodes, self.mean, self.std)

    def below(self, located: Located) -> F64:
        """Height (n,) of located points over the surface [m]."""
        return self._below(located, False)[0]

    def below_with_std(self, located: Located) -> tuple[F64, F32]:
        """Height (n,) of located points over the surface, and its deviation (n,) there [m]."""
        return self._below(located, True)

    def _below(self, located: Located, with_std: bool) -> tuple[F64, F32]:
        n = len(located.points)
        over, std = np.empty(n), np.empty(n, np.float32)
        arrays = (located.points, located.cell, located.azimuth, located.radius, over, std)
        over_rows(over_points, arrays, (with_std, self.plane, self.nodes, self.mean, self.std))
        return over, std
