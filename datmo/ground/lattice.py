"""A surface on polar nodes under a thin-plate and membrane prior, solved line by line.

Minimises over the heights f of the nodes
    Σ w_i (y_i - f(x_i))² + ∬ (f_rr² + f_tt²) / τ² + (f_r² + f_t²) / ς² dA + ρ Σ f²
where f(x_i) is bilinear in azimuth and radius. With its neighbours held, a line along the radius is
a system of five bands, solved exactly; all lines are solved at once, and the steps weighted by Chebyshev.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, I64

TURN = 2 * np.pi
WRAP = 2  # lines repeated at either end of a turn, so that none needs a search for its neighbours


@dataclass(frozen=True)
class Lattice:
    """Nodes of M lines, at the middles of equal angles, by N radii [m].

    Attributes:
        lines: M. radii: (N,) increasing [m].
    """

    lines: int
    radii: F64

    @property
    def arcs(self) -> F64:
        """(N,) distance between neighbouring lines at each radius [m]."""
        return self.radii * (TURN / self.lines)

    @property
    def areas(self) -> F64:
        """(N,) area of each node's patch [m²]."""
        return np.gradient(self.radii) * self.arcs


@dataclass(frozen=True)
class Prior:
    """The quadratic form of the prior along and across lines.

    Attributes:
        bands: (3, N) diagonal, first and second off-diagonal of a line with its neighbours held.
        next, second: (N,) how a node pulls towards the nodes one line and two lines off.
    """

    bands: F64
    next: F64
    second: F64


def prior(lattice: Lattice, bend: float, slope: float, ridge: float, noise: float) -> Prior:
    """The prior in units of 1 / noise².

    Args:
        bend: τ, spread of curvature, [1/m] times the root of area [m]: the std of the second difference
            over h is about τ h. slope: ς likewise for first differences: their std is about ς, whatever h.
        ridge: std of a node's height itself [m]. noise: [m].
    """
    r, arc, area = lattice.radii, lattice.arcs, lattice.areas
    n = len(r)
    second = np.zeros((max(n - 2, 0), n))
    h = np.diff(r)
    for i in range(n - 2):
        a, b = h[i], h[i + 1]
        second[i, i : i + 3] = 2 / (a * (a + b)), -2 / (a * b), 2 / (b * (a + b))
    first = np.zeros((n - 1, n))
    first[np.arange(n - 1), np.arange(n - 1)], first[np.arange(n - 1), np.arange(1, n)] = -1 / h, 1 / h
    kb, ks = area * (noise / bend) ** 2, area * (noise / slope) ** 2
    dense = second.T @ (kb[1:-1, None] * second) + first.T @ (((ks[1:] + ks[:-1]) / 2)[:, None] * first)
    tb, ts = kb / arc**4, ks / arc**2
    bands = np.zeros((3, n))
    for k in range(3):
        bands[k, : n - k] = np.diagonal(dense, k)
    bands[0] += 6 * tb + 2 * ts + (noise / ridge) ** 2
    return Prior(bands, 4 * tb + ts, -tb)


@numba.njit(cache=True, nogil=True)
def corners(azimuth: F64, radius: F64, lines: int, segments: int, radii: F64) -> tuple[I64, F64, I64, F64]:
    """Line before each place, share of the next one, node below it, and share of the next one.

    Args:
        azimuth: (n,) in segments of which a turn has `segments`. radius: (n,) [m], held to the radii.
    """
    n = len(azimuth)
    line, s, node, t = np.empty(n, np.int64), np.empty(n), np.empty(n, np.int64), np.empty(n)
    for i in range(n):
        u = azimuth[i] * (lines / segments) - 0.5
        k = int(np.floor(u))
        line[i], s[i] = k % lines, u - k
        b = min(max(np.searchsorted(radii, radius[i], side="right") - 1, 0), len(radii) - 2)
        node[i] = b
        t[i] = min(max((radius[i] - radii[b]) / (radii[b + 1] - radii[b]), 0.0), 1.0)
    return line, s, node, t


@numba.njit(cache=True, nogil=True)
def evaluate(f: F64, line: I64, s: F64, node: I64, t: F64) -> F64:
    """Height (n,) of the surface f (M, N) at places given by `corners`."""
    out, M = np.empty(len(line)), len(f)
    for i in range(len(line)):
        a, q = line[i], node[i]
        b = a + 1 if a + 1 < M else 0
        low = (1 - t[i]) * f[a, q] + t[i] * f[a, q + 1]
        high = (1 - t[i]) * f[b, q] + t[i] * f[b, q + 1]
        out[i] = (1 - s[i]) * low + s[i] * high
    return out


@numba.njit(cache=True, nogil=True)
def gather(w: F64, y: F64, line: I64, s: F64, node: I64, t: F64, out: F64) -> None:
    """Normal equations of the observations, written to `out` (5, N, 1 + M): a line's diagonal and first
    off-diagonal, the same of its coupling with the next line, and the right-hand side; the last line
    stands before the first once more."""
    out[:] = 0.0
    M = out.shape[2] - 1
    for i in range(len(w)):
        if w[i] == 0.0:
            continue
        a, q = 1 + line[i], node[i]
        b = a + 1 if a < M else 1
        t1 = t[i]
        t0 = 1 - t1
        s1 = s[i]
        s0 = 1 - s1
        for m, weight in ((a, w[i] * s0 * s0), (b, w[i] * s1 * s1)):
            out[0, q, m] += weight * t0 * t0
            out[0, q + 1, m] += weight * t1 * t1
            out[1, q, m] += weight * t0 * t1
        cross = w[i] * s0 * s1
        out[2, q, a] += cross * t0 * t0
        out[2, q + 1, a] += cross * t1 * t1
        out[3, q, a] += cross * t0 * t1
        pull = w[i] * y[i]
        out[4, q, a] += pull * s0 * t0
        out[4, q + 1, a] += pull * s0 * t1
        out[4, q, b] += pull * s1 * t0
        out[4, q + 1, b] += pull * s1 * t1
    out[:, :, 0] = out[:, :, M]


@numba.njit(cache=True, nogil=True)
def factor(normal: F64, bands: F64) -> F64:
    """L D Lᵀ of every line with its neighbours held: 1 / D, first and second factor below the diagonal,
    (3, N, M).

    Args:
        normal: (5, N, 1 + M) of `gather`. bands: of `Prior`.
    """
    N, M = normal.shape[1], normal.shape[2] - 1
    out = np.zeros((3, N, M))
    inverse, e, g = out
    for b in range(N):
        for m in range(M):
            d = normal[0, b, 1 + m] + bands[0, b]
            off = normal[1, b, 1 + m] + bands[1, b]
            if b > 0:
                d -= e[b - 1, m] * e[b - 1, m] / inverse[b - 1, m]
                off -= e[b - 1, m] * bands[2, b - 1]
            if b > 1:
                d -= g[b - 2, m] * bands[2, b - 2]
            inverse[b, m] = 1 / d
            e[b, m] = off * inverse[b, m]
            g[b, m] = bands[2, b] * inverse[b, m]
    return out


@numba.njit(cache=True, nogil=True)
def _right(f: F64, normal: F64, near: F64, second: F64, x: F64) -> None:
    """Right-hand side of every line with its neighbours in f (N, M + 2 WRAP) held, written to x (N, M)."""
    N, M = x.shape
    pull, same, skew = normal[4], normal[2], normal[3]
    for b in range(N):
        one, two = near[b], second[b]
        for m in range(M):
            k = m + WRAP
            x[b, m] = pull[b, m + 1] + one * (f[b, k - 1] + f[b, k + 1]) + two * (f[b, k - 2] + f[b, k + 2])
            x[b, m] -= same[b, m + 1] * f[b, k + 1] + same[b, m] * f[b, k - 1]
        if b + 1 < N:
            for m in range(M):
                x[b, m] -= skew[b, m + 1] * f[b + 1, m + WRAP + 1] + skew[b, m] * f[b + 1, m + WRAP - 1]
        if b > 0:
            for m in range(M):
                x[b, m] -= skew[b - 1, m + 1] * f[b - 1, m + WRAP + 1]
                x[b, m] -= skew[b - 1, m] * f[b - 1, m + WRAP - 1]


@numba.njit(cache=True, nogil=True)
def _solve(x: F64, factors: F64) -> None:
    """Every line of the right-hand side x (N, M), solved in place by `factors`."""
    N, M = x.shape
    inverse, e, g = factors
    for b in range(1, N):
        for m in range(M):
            x[b, m] -= e[b - 1, m] * x[b - 1, m]
        if b > 1:
            for m in range(M):
                x[b, m] -= g[b - 2, m] * x[b - 2, m]
    for b in range(N - 1, -1, -1):
        for m in range(M):
            x[b, m] *= inverse[b, m]
        if b + 1 < N:
            for m in range(M):
                x[b, m] -= e[b, m] * x[b + 1, m]
        if b + 2 < N:
            for m in range(M):
                x[b, m] -= g[b, m] * x[b + 2, m]


@numba.njit(cache=True, nogil=True)
def relax(f: F64, normal: F64, factors: F64, near: F64, second: F64, steps: F64) -> None:
    """Draw f (M, N), in place, to the solution in some `steps` (k, 2) of `chebyshev`.

    Args:
        normal: (5, N, 1 + M) of `gather`. factors: of `factor`. near, second: of `Prior`.
    """
    M, N = f.shape
    x, step, g = np.empty((N, M)), np.zeros((N, M)), np.empty((N, M + 2 * WRAP))
    g[:, WRAP : M + WRAP] = f.T
    for k in range(len(steps)):
        g[:, :WRAP], g[:, M + WRAP :] = g[:, M : M + WRAP], g[:, WRAP : 2 * WRAP]
        _right(g, normal, near, second, x)
        _solve(x, factors)
        alpha, beta = steps[k]
        for b in range(N):
            for m in range(M):
                step[b, m] = alpha * (x[b, m] - g[b, m + WRAP]) + beta * step[b, m]
                g[b, m + WRAP] += step[b, m]
    f[:] = g[:, WRAP : M + WRAP].T
