"""A membrane over polar cells: neighbouring nodes pull at each other with precision 1 / (c d).

That is the prior E[Δz²] = c d. With its neighbours held, a line along the radius is a tridiagonal system,
solved exactly; all lines are solved at once, and the steps weighted by Chebyshev. Arrays within are
(N, M), so that the lines lie side by side.
"""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64


@numba.njit(cache=True, nogil=True)
def links(c: F64, r: F64) -> tuple[F64, F64]:
    """Precision [1/m²] of the difference of each node from the next outwards, (N - 1, M), and from the same
    node of the next line, (N, M).

    Args:
        c: (M, N) [m]. r: (N,) range of the nodes [m].
    """
    M, N = c.shape
    ct = np.ascontiguousarray(c.T)
    out, across = np.empty((N - 1, M)), np.empty((N, M))
    for b in range(N):
        arc = 2 * np.pi / M * r[b]
        for m in range(M):
            across[b, m] = 2 / ((ct[b, m] + ct[b, m + 1 if m + 1 < M else 0]) * arc)
        if b + 1 < N:
            step = r[b + 1] - r[b]
            for m in range(M):
                out[b, m] = 2 / ((ct[b, m] + ct[b + 1, m]) * step)
    return out, across


@numba.njit(cache=True, nogil=True)
def factor(w: F64, out: F64, across: F64, ridge: float) -> tuple[F64, F64]:
    """Of every line with its neighbours held: 1 / pivots, and the share of the next node in each, (N, M).

    Args:
        w: (N, M) precision of each observation, 0 without one. out, across: of `links`. ridge: precision
        of a node about 0.
    """
    N, M = w.shape
    inverse, upper = np.empty((N, M)), np.zeros((N, M))
    for b in range(N):
        for m in range(M):
            diagonal = w[b, m] + ridge + across[b, m] + across[b, m - 1 if m > 0 else M - 1]
            if b > 0:
                diagonal += out[b - 1, m] * (1 - upper[b - 1, m])
            if b + 1 < N:
                diagonal += out[b, m]
                upper[b, m] = out[b, m] / diagonal
            inverse[b, m] = 1 / diagonal
    return inverse, upper


@numba.njit(cache=True, nogil=True)
def solve(f: F64, pull: F64, inverse: F64, upper: F64, out: F64, across: F64, x: F64) -> None:
    """Every line with its neighbours in f held (Thomas), written to x; all (N, M).

    Args:
        pull: precision x observed height. inverse, upper: of `factor`. out, across: of `links`.
    """
    N, M = f.shape
    for b in range(N):
        x[b, 0] = pull[b, 0] + across[b, 0] * f[b, 1] + across[b, M - 1] * f[b, M - 1]
        x[b, M - 1] = pull[b, M - 1] + across[b, M - 1] * f[b, 0] + across[b, M - 2] * f[b, M - 2]
        for m in range(1, M - 1):
            x[b, m] = pull[b, m] + across[b, m] * f[b, m + 1] + across[b, m - 1] * f[b, m - 1]
        if b > 0:
            for m in range(M):
                x[b, m] += out[b - 1, m] * x[b - 1, m]
        for m in range(M):
            x[b, m] *= inverse[b, m]
    for b in range(N - 2, -1, -1):
        for m in range(M):
            x[b, m] += upper[b, m] * x[b + 1, m]


@numba.njit(cache=True, nogil=True)
def settle(f: F64, w: F64, y: F64, out: F64, across: F64, ridge: float, steps: F64) -> None:
    """Draw the heights f (M, N), in place, towards y of precision w, both (M, N), in some `steps` (k, 2)."""
    g, wt = np.ascontiguousarray(f.T), np.ascontiguousarray(w.T)
    pull = wt * y.T
    inverse, upper = factor(wt, out, across, ridge)
    x, step = np.empty(g.shape), np.zeros(g.shape)
    for k in range(len(steps)):
        alpha, beta = steps[k]
        solve(g, pull, inverse, upper, out, across, x)
        for b in range(len(g)):
            for m in range(g.shape[1]):
                step[b, m] = alpha * (x[b, m] - g[b, m]) + beta * step[b, m]
                g[b, m] += step[b, m]
    f[:] = g.T
