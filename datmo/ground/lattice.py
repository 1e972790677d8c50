"""A surface on polar nodes under a thin-plate and membrane prior, solved line by line.

Minimises over the heights f of the nodes
    Σ w_i (y_i - f(x_i))² + ∬ (f_rr² + f_tt²) / τ² + (f_r² + f_t²) / ς² dA + ρ Σ f²
where f(x_i) is bilinear in azimuth and radius. With its neighbours held, a line along the radius is
a system of five bands, solved exactly; lines take turns (Gauss-Seidel by line).
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, I64

TURN = 2 * np.pi


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
    out = np.empty(len(line))
    for i in range(len(line)):
        a, b, q = line[i], (line[i] + 1) % len(f), node[i]
        low = (1 - t[i]) * f[a, q] + t[i] * f[a, q + 1]
        high = (1 - t[i]) * f[b, q] + t[i] * f[b, q + 1]
        out[i] = (1 - s[i]) * low + s[i] * high
    return out


@numba.njit(cache=True, nogil=True)
def gather(w: F64, y: F64, line: I64, s: F64, node: I64, t: F64, out: F64) -> None:
    """Normal equations of the observations, written to `out` (5, M, N): a line's diagonal and first
    off-diagonal, the same of its coupling with the next line, and the right-hand side."""
    out[:] = 0.0
    M = out.shape[1]
    for i in range(len(w)):
        if w[i] == 0.0:
            continue
        a, q = line[i], node[i]
        b = a + 1 if a + 1 < M else 0
        t1 = t[i]
        t0 = 1 - t1
        s1 = s[i]
        s0 = 1 - s1
        for m, weight in ((a, w[i] * s0 * s0), (b, w[i] * s1 * s1)):
            out[0, m, q] += weight * t0 * t0
            out[0, m, q + 1] += weight * t1 * t1
            out[1, m, q] += weight * t0 * t1
        cross = w[i] * s0 * s1
        out[2, a, q] += cross * t0 * t0
        out[2, a, q + 1] += cross * t1 * t1
        out[3, a, q] += cross * t0 * t1
        pull = w[i] * y[i]
        out[4, a, q] += pull * s0 * t0
        out[4, a, q + 1] += pull * s0 * t1
        out[4, b, q] += pull * s1 * t0
        out[4, b, q + 1] += pull * s1 * t1


@numba.njit(cache=True, nogil=True)
def solve_bands(d: F64, e: F64, g: F64, x: F64) -> None:
    """Solve the symmetric system of diagonals d, e, g in place of its right-hand side x.

    By L D Lᵀ; afterwards d holds D, and e and g the first and second factor below the diagonal.
    """
    n = len(d)
    for i in range(n):
        if i + 1 < n:
            p = e[i] / d[i]
            d[i + 1] -= p * e[i]
            x[i + 1] -= p * x[i]
            if i + 2 < n:
                e[i + 1] -= p * g[i]
            e[i] = p
        if i + 2 < n:
            p = g[i] / d[i]
            d[i + 2] -= p * g[i]
            x[i + 2] -= p * x[i]
            g[i] = p
    for i in range(n - 1, -1, -1):
        x[i] /= d[i]
        if i + 1 < n:
            x[i] -= e[i] * x[i + 1]
        if i + 2 < n:
            x[i] -= g[i] * x[i + 2]


@numba.njit(cache=True, nogil=True)
def relax(f: F64, normal: F64, bands: F64, near: F64, second: F64, first: int, last: int) -> None:
    """One turn of lines first..last-1, each solved with its neighbours held; f (M, N) in place.

    Args:
        normal: (5, M, N) of `gather`. bands, near, second: of `Prior`.
    """
    M, N = f.shape
    d, e, g, x = np.empty(N), np.empty(N), np.empty(N), np.empty(N)
    for m in range(first, last):
        p, q = m - 1 if m > 0 else M - 1, m + 1 if m + 1 < M else 0
        before, after = f[p], f[q]
        before2, after2 = f[p - 1 if p > 0 else M - 1], f[q + 1 if q + 1 < M else 0]
        for b in range(N):
            d[b] = normal[0, m, b] + bands[0, b]
            e[b] = normal[1, m, b] + bands[1, b]
            g[b] = bands[2, b]
            x[b] = normal[4, m, b] + near[b] * (before[b] + after[b]) + second[b] * (before2[b] + after2[b])
            x[b] -= normal[2, m, b] * after[b] + normal[2, p, b] * before[b]
        for b in range(N - 1):
            x[b] -= normal[3, m, b] * after[b + 1] + normal[3, p, b] * before[b + 1]
            x[b + 1] -= normal[3, m, b] * after[b] + normal[3, p, b] * before[b]
        solve_bands(d, e, g, x)
        for b in range(N):
            f[m, b] = x[b]
