"""The method `default`: one field over all cells, tied along range and azimuth, of learned local roughness.

ISO 8608 ground has height differences whose variance grows with distance, E[Δz²] = c d (its profiles fall as
n⁻²). The field takes that as its prior (see `membrane`), c learned in each frame around every cell from the
differences of neighbouring cells.
"""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, Bool
from datmo.ground.chebyshev import weights
from datmo.ground.config import GroundConfig
from datmo.ground.grid import PolarGrid
from datmo.ground.membrane import links, settle
from datmo.ground.regression import Cells, Heights, Learned, Regression

SMOOTHEST = 1e-7
GROWTH_SCALES = (0.12, 0.06, 0.04)
BELOW = 2.0
DOUBT = 20.0
# A line's neighbours pull at it at most as much as all that holds it.
GROWTH_STEPS, STEPS = weights(3, 0.3, 2.0), weights(4, 0.3, 2.0)
WINDOW_LINES, WINDOW_BINS = 3, 3
PRIOR_CELLS = 4.0
LARGEST_STEP = 0.3
TINY = 1e-9
PULL = 0.04  # how far a cell's mean may be off, as a share of c times the cell's size
# Std of the height at the middle of a cell over sqrt(c size), and of one between seen cells over
# sqrt(c / Σ 1/d), by range [m]: fitted to the true heights of simulated ground of classes A to G. They grow
# with range, since grazing rays meet the crests only.
RANGES = (5.0, 15.0, 25.0, 35.0, 45.0)
SEEN_STD = (0.4, 0.7, 1.0, 1.4, 4.2)
BETWEEN_STD = (1.2, 1.5, 1.5, 2.2, 5.0)


@numba.njit(cache=True, nogil=True)
def robust(y: F64, use: Bool, noise: F64, out: F64, across: F64, ridge: float) -> F64:
    """The field (M, N) through `y` where `use`, in rounds: weights fall with the distance above the field,
    and less with that below."""
    f, w = np.zeros(y.shape), np.zeros(y.shape)
    for scale in GROWTH_SCALES:
        for m in range(len(y)):
            for b in range(y.shape[1]):
                e = (y[m, b] - f[m, b]) / scale
                u = e if e > 0 else e / BELOW
                fall = 1 + u * u
                w[m, b] = 1 / (noise[m, b] * fall * fall) if use[m, b] else 0.0
        settle(f, w, y, out, across, ridge, GROWTH_STEPS)
    return f


@numba.njit(cache=True, nogil=True)
def roughness(y: F64, use: Bool, noise: F64, r: F64, start: float) -> tuple[F64, float]:
    """c (M, N) around each cell, and of the frame [m]: Σ (Δy² - noise) / Σ d over neighbouring cells.

    Pairs are a cell and the next used one outwards or in the next line; a local window shares with the frame
    as if that were a few more pairs.

    Args:
        y: (M, N) height of each cell [m]. noise: (M, N) variance of its error [m²]. start: c without pairs.
    """
    M, N = y.shape
    square, span = np.zeros((M, N)), np.zeros((M, N))
    width = 2 * np.pi / M
    for m in range(M):
        o = m + 1 if m + 1 < M else 0
        last = -1
        for b in range(N):
            if not use[m, b]:
                continue
            if last >= 0 and b - last <= 2:
                step = min(abs(y[m, b] - y[m, last]), LARGEST_STEP)
                square[m, b] += step * step - noise[m, b] - noise[m, last]
                span[m, b] += r[b] - r[last]
            if use[o, b]:
                step = min(abs(y[m, b] - y[o, b]), LARGEST_STEP)
                square[m, b] += step * step - noise[m, b] - noise[o, b]
                span[m, b] += width * r[b]
            last = b
    whole = span.sum()
    frame = max(square.sum() / whole, SMOOTHEST) if whole > 0 else start
    return _window(square, span, frame), frame


@numba.njit(cache=True, nogil=True)
def _window(square: F64, span: F64, frame: float) -> F64:
    """c by sums over a window about each cell; the frame weighs as `PRIOR_CELLS` more cells."""
    M, N = square.shape
    s, d = np.zeros((M, N)), np.zeros((M, N))
    for m in range(M):
        for o in range(m - WINDOW_LINES, m + WINDOW_LINES + 1):
            row = (o + M) % M
            for b in range(N):
                s[m, b] += square[row, b]
                d[m, b] += span[row, b]
    c = np.empty((M, N))
    for m in range(M):
        for b in range(N):
            first, last = max(b - WINDOW_BINS, 0), min(b + WINDOW_BINS + 1, N)
            total, length = 0.0, 0.0
            for k in range(first, last):
                total += s[m, k]
                length += d[m, k]
            extra = PRIOR_CELLS * 0.5
            c[m, b] = max((total + extra * frame) / (length + extra), SMOOTHEST)
    return c


@numba.njit(cache=True, nogil=True)
def conductance(use: Bool, r: F64) -> F64:
    """Σ 1 / d (M, N) [1/m] over the nearest used cell inwards, outwards and to both sides: as resistors of
    c d each, c / Σ 1/d is the variance of a node between them. For used cells too, themselves left out."""
    M, N = use.shape
    g = np.zeros((M, N))
    width = 2 * np.pi / M
    for m in range(M):
        for step in (1, -1):
            last = -1
            for k in range(N):
                b = k if step > 0 else N - 1 - k
                if last >= 0:
                    g[m, b] += 1 / abs(r[b] - r[last])
                if use[m, b]:
                    last = b
    for step in (1, -1):
        latest = np.full(N, -10 * M)
        for k in range(2 * M):
            m = (k if step > 0 else 2 * M - 1 - k) % M
            for b in range(N):
                if k >= M and latest[b] > -M:
                    g[m, b] += 1 / ((k - latest[b]) * width * r[b])
                if use[m, b]:
                    latest[b] = k
    return g


@numba.njit(cache=True, nogil=True)
def to_middle(f: F64, y: F64, use: Bool, r: F64, azimuth: F64, centers: F64) -> None:
    """Move each height y (M, N) from its place to the middle of its cell along the slopes of f, in place."""
    M, N = f.shape
    for m in range(M):
        p, q = m - 1 if m > 0 else M - 1, m + 1 if m + 1 < M else 0
        for b in range(N):
            if use[m, b]:
                i, k = max(b - 1, 0), min(b + 1, N - 1)
                along = (f[m, k] - f[m, i]) / (centers[k] - centers[i])
                y[m, b] -= along * (r[m, b] - centers[b])
                y[m, b] -= (f[q, b] - f[p, b]) / 2 * (azimuth[m, b] - m - 0.5)


class Field(Regression):
    """One Gaussian field over all cells, see the module."""

    def __init__(self, grid: PolarGrid, config: GroundConfig) -> None:
        self._r, self.config = grid.centers, config
        self._size = np.sqrt(grid.areas)
        self._ridge = 1 / config.most_std**2
        self._seen_share = np.interp(grid.centers, RANGES, SEEN_STD) ** 2
        self._between_share = np.interp(grid.centers, RANGES, BETWEEN_STD) ** 2

    def start(self) -> Learned:
        """A class-E ground."""
        none = np.zeros(0, np.int32)
        return Learned({"c": 1e-3}, none, none, none)

    def grow(
        self,
        cells: Cells,
        seed: Bool,  # noqa: ARG002 - the rounds find their own way from the sheet
        doubtful: Bool,
        learned: Learned,
    ) -> tuple[Bool, Heights]:
        """Robust rounds: weights fall with the distance above the field, and less with that below."""
        c = np.full(cells.y.shape, learned.hyper["c"])
        out, across = links(c, self._r)
        noise = np.where(doubtful, DOUBT, 1.0) * (self.config.noise_std**2 + c * self._size)
        y = np.where(cells.use, cells.y, 0.0)
        f = robust(y, cells.use, noise, out, across, self._ridge)
        member = cells.use & (np.abs(y - f) < self.config.seed_height) & ~doubtful
        observed = self.config.noise_floor**2 + c * self._size
        return member, self._heights(f, c * self._size, observed)

    def fit(self, cells: Cells, learned: Learned) -> tuple[Heights, Learned]:
        """The field through the cells' means, its roughness learned around each."""
        y = np.where(cells.use, cells.y, 0.0)
        noise = np.full(y.shape, self.config.noise_floor**2) if cells.noise is None else cells.noise
        c, frame = roughness(y, cells.use, noise, self._r, learned.hyper["c"])
        out, across = links(c, self._r)
        w = np.where(cells.use, 1 / (noise + PULL * c * self._size), 0.0)
        f = y.copy()
        settle(f, w, y, out, across, self._ridge, STEPS)
        if cells.azimuth is not None:
            to_middle(f, y, cells.use, cells.r, cells.azimuth, self._r)
        settle(f, w, y, out, across, self._ridge, STEPS)
        seen = noise + self._seen_share * c * self._size
        between = self._between_share * c / np.maximum(conductance(cells.use, self._r), TINY)
        var = np.minimum(np.where(cells.use, seen, between), self.config.most_std**2)
        count, none = cells.use.sum(1).astype(np.int32), np.zeros(len(y), np.int32)
        return self._heights(f, var, noise + c * self._size), Learned(
            {"c": frame}, count, none, none, frames=learned.frames + 1
        )

    def _heights(self, f: F64, var: F64, noise: F64) -> Heights:
        """On the nodes: the first and last bin hold beyond."""

        def pad(a: F64) -> F64:
            return np.concatenate([a[:, :1], a, a[:, -1:]], axis=1)

        return Heights(pad(f), pad(var), pad(noise))
