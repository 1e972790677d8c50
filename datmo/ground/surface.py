"""The ground at any place: Gaussian processes of all segments, joined along azimuth."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, Bool
from datmo.messages import Surface
from datmo.messages.base import Message

BEYOND = 0.1


@numba.njit(cache=True, nogil=True)
def _corner(nodes: F64, radius: float) -> tuple[int, float]:
    """Column left of `radius` and the share of the next one."""
    q = min(max(int(np.searchsorted(nodes, radius, side="right")) - 1, 0), len(nodes) - 2)
    return q, min((radius - nodes[q]) / (nodes[q + 1] - nodes[q]), 1.0)


@numba.njit(cache=True, nogil=True)
def interpolate(
    x: F64, y: F64, azimuth: F64, radius: F64, plane: F64, nodes: F64, table: F64, spread: F64
) -> tuple[F64, F64]:
    """Height and deviation (n,) at (x, y), whose azimuth [segments] and radius [m] are known.

    Bilinear in azimuth and radius; rows stand at the middle of their segment and close around. NaN
    where the azimuth is.
    """
    M, last = len(table), nodes[-1]
    mean, std = np.full(len(x), np.nan), np.full(len(x), np.nan)
    for i in range(len(x)):
        if np.isnan(azimuth[i]):
            continue
        s = azimuth[i] - 0.5
        m = int(np.floor(s))
        f = s - m
        a, b = m % M, (m + 1) % M
        q, t = _corner(nodes, radius[i])
        over = (1 - f) * ((1 - t) * table[a, q] + t * table[a, q + 1])
        over += f * ((1 - t) * table[b, q] + t * table[b, q + 1])
        v = (1 - f) * ((1 - t) * spread[a, q] + t * spread[a, q + 1])
        v += f * ((1 - t) * spread[b, q] + t * spread[b, q + 1])
        mean[i] = over + plane[0] * x[i] + plane[1] * y[i] + plane[2]
        std[i] = np.hypot(v, BEYOND * max(radius[i] - last, 0.0))
    return mean, std


@numba.njit(cache=True, nogil=True)
def gaps(seen: Bool, bins: F64, nodes: F64) -> F64:
    """About how far (M, Q) each node is from the nearest seen cell, along range and arc [m].

    Args:
        seen: (M, N). bins: (N,) where the cells stand [m]. nodes: (Q,) [m].
    """
    M, Q = len(seen), len(nodes)
    gap = np.full((M, Q), np.inf)
    for m in range(M):
        for b in np.flatnonzero(seen[m]):
            q = np.searchsorted(nodes, bins[b])
            gap[m, q] = min(gap[m, q], abs(nodes[q] - bins[b]))
        for q in range(1, Q):
            gap[m, q] = min(gap[m, q], gap[m, q - 1] + nodes[q] - nodes[q - 1])
        for q in range(Q - 2, -1, -1):
            gap[m, q] = min(gap[m, q], gap[m, q + 1] + nodes[q + 1] - nodes[q])
    arc = 2 * np.pi / M * nodes
    for m in range(2 * M):
        gap[m % M] = np.minimum(gap[m % M], gap[(m - 1) % M] + arc)
    for m in range(2 * M, 0, -1):
        gap[m % M] = np.minimum(gap[m % M], gap[(m + 1) % M] + arc)
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
