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
FRONTS = 4  # lines that are solved together


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
def factor(normal: F64, bands: F64) -> F64:
    """L D Lᵀ of every line with its neighbours held: 1 / D, first and second factor below the diagonal,
    (3, M, N).

    Args:
        normal: (5, M, N) of `gather`. bands: of `Prior`.
    """
    _, M, N = normal.shape
    out = np.zeros((3, M, N))
    inverse, e, g = out
    for b in range(N):  # all lines together: each waits for its own divisions only
        for m in range(M):
            d = normal[0, m, b] + bands[0, b]
            off = normal[1, m, b] + bands[1, b]
            if b > 0:
                d -= e[m, b - 1] * e[m, b - 1] / inverse[m, b - 1]
                off -= e[m, b - 1] * bands[2, b - 1]
            if b > 1:
                d -= g[m, b - 2] * bands[2, b - 2]
            inverse[m, b] = 1 / d
            e[m, b] = off * inverse[m, b]
            g[m, b] = bands[2, b] * inverse[m, b]
    return out


@numba.njit(cache=True, nogil=True)
def _right(f: F64, normal: F64, near: F64, second: F64, m: int, x: F64) -> None:
    """Right-hand side (N,) of line m with its neighbours held, written to x."""
    M, N = f.shape
    p, q = m - 1 if m > 0 else M - 1, m + 1 if m + 1 < M else 0
    before, after = f[p], f[q]
    before2, after2 = f[p - 1 if p > 0 else M - 1], f[q + 1 if q + 1 < M else 0]
    for b in range(N):
        x[b] = normal[4, m, b] + near[b] * (before[b] + after[b]) + second[b] * (before2[b] + after2[b])
        x[b] -= normal[2, m, b] * after[b] + normal[2, p, b] * before[b]
    for b in range(N - 1):
        x[b] -= normal[3, m, b] * after[b + 1] + normal[3, p, b] * before[b + 1]
    for b in range(N - 1):
        x[b + 1] -= normal[3, m, b] * after[b] + normal[3, p, b] * before[b]


@numba.njit(cache=True, nogil=True)
def relax(f: F64, normal: F64, factors: F64, near: F64, second: F64) -> None:
    """One turn of all lines, each solved with its neighbours held; f (M, N) in place.

    `FRONTS` lines far from each other are solved together, which hides the wait of each for itself.

    Args:
        normal: (5, M, N) of `gather`. factors: of `factor`. near, second: of `Prior`.
    """
    M, N = f.shape
    inverse, e, g = factors
    fronts = FRONTS if M >= 3 * FRONTS else 1
    step = M // fronts
    x = np.zeros((FRONTS, N + 2))
    for j in range(step + M % fronts):
        lines = fronts if j < step else 1
        first = j if j < step else M - M % fronts + j - step
        for k in range(lines):
            _right(f, normal, near, second, first + k * step, x[k, :N])
        for b in range(1, N):
            for k in range(lines):
                m = first + k * step
                x[k, b] -= e[m, b - 1] * x[k, b - 1]
                if b > 1:
                    x[k, b] -= g[m, b - 2] * x[k, b - 2]
        for b in range(N - 1, -1, -1):
            for k in range(lines):
                m = first + k * step
                x[k, b] = x[k, b] * inverse[m, b] - e[m, b] * x[k, b + 1] - g[m, b] * x[k, b + 2]
        for k in range(lines):
            f[first + k * step] = x[k, :N]
            x[k, N:] = 0.0
