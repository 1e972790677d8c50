"""A coarse two-dimensional ground: a bicubic spline sheet under tension, blind to obstacles.

It is the mean h0 of the Gaussian processes and ties their segments together. Minimises
    Σ w_i (z_i - f(x_i, y_i))² / σ² + Σ (second differences)² / σ_b² + Σ (first differences)² / σ_s²
over the knots' coefficients by conjugate gradients, warm-started while the weights w_i settle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, I64

RIDGE_STD = 3.0
STEPS = 12
QUANTILE_ROUNDS, ROBUST_ROUNDS = 5, 5
QUANTILE = 0.35


@dataclass(frozen=True)
class SheetRules:
    """Scatter of points, std of second and first differences over a cell [m], and asymmetry."""

    noise: float
    bend: float
    slope: float
    asymmetric: bool


@numba.njit(cache=True, nogil=True)
def basis(xy: F64, cell: float, knots: int) -> tuple[I64, F64, F64]:
    """First knot (n,), x by x, and cubic B-spline weights (n, 4) along x and along y of each place."""
    n = len(xy)
    first, wx, wy = np.zeros(n, np.int64), np.empty((n, 4)), np.empty((n, 4))
    for i in range(n):
        for k in range(2):
            u = xy[i, k] / cell + (knots - 3) / 2
            u = min(max(u, 0.0), knots - 3 - 1e-9)
            j = int(u)
            t = u - j
            first[i] = first[i] * knots + j
            w = wx if k == 0 else wy
            w[i, 0] = (1 - t) ** 3 / 6
            w[i, 1] = (3 * t**3 - 6 * t**2 + 4) / 6
            w[i, 2] = (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6
            w[i, 3] = t**3 / 6
    return first, wx, wy


@numba.njit(cache=True, nogil=True)
def value(c: F64, first: I64, wx: F64, wy: F64) -> F64:
    """Height (n,) of the sheet with coefficients c (knots, knots)."""
    out, flat, knots = np.empty(len(first)), c.ravel(), len(c)
    for i in range(len(first)):
        u, height = wy[i], 0.0
        for a in range(4):
            j = first[i] + a * knots
            row = u[0] * flat[j] + u[1] * flat[j + 1] + u[2] * flat[j + 2] + u[3] * flat[j + 3]
            height += wx[i, a] * row
        out[i] = height
    return out


@numba.njit(cache=True, nogil=True)
def _spread(v: F64, first: I64, wx: F64, wy: F64, out: F64) -> None:
    """Add the transpose of `value` applied to v to `out` (knots, knots)."""
    flat, knots = out.reshape(-1), len(out)
    for i in range(len(first)):
        u = wy[i]
        for a in range(4):
            j, w = first[i] + a * knots, v[i] * wx[i, a]
            flat[j] += w * u[0]
            flat[j + 1] += w * u[1]
            flat[j + 2] += w * u[2]
            flat[j + 3] += w * u[3]


@numba.njit(cache=True, nogil=True)
def _stiffness(c: F64, bend: float, slope: float, out: F64) -> None:
    """Add the gradient of the differences' penalty to `out`, all (knots, knots)."""
    n = len(c)
    for i in range(n):
        for j in range(n):
            if i + 1 < n:
                e = slope * (c[i + 1, j] - c[i, j])
                out[i + 1, j] += e
                out[i, j] -= e
            if j + 1 < n:
                e = slope * (c[i, j + 1] - c[i, j])
                out[i, j + 1] += e
                out[i, j] -= e
            if 0 < i < n - 1:
                e = bend * (c[i + 1, j] - 2 * c[i, j] + c[i - 1, j])
                out[i + 1, j] += e
                out[i, j] -= 2 * e
                out[i - 1, j] += e
            if 0 < j < n - 1:
                e = bend * (c[i, j + 1] - 2 * c[i, j] + c[i, j - 1])
                out[i, j + 1] += e
                out[i, j] -= 2 * e
                out[i, j - 1] += e
            if i + 1 < n and j + 1 < n:
                e = 2 * bend * (c[i + 1, j + 1] - c[i + 1, j] - c[i, j + 1] + c[i, j])
                out[i + 1, j + 1] += e
                out[i, j] += e
                out[i + 1, j] -= e
                out[i, j + 1] -= e


@numba.njit(cache=True, nogil=True)
def _apply(p: F64, w: F64, first: I64, wx: F64, wy: F64, bend: float, slope: float, ridge: float) -> F64:
    """The normal matrix applied to p."""
    out = ridge * p
    _spread(w * value(p, first, wx, wy), first, wx, wy, out)
    _stiffness(p, bend, slope, out)
    return out


@numba.njit(cache=True, nogil=True)
def _dot(a: F64, b: F64) -> float:
    s = 0.0
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            s += a[i, j] * b[i, j]
    return s


@numba.njit(cache=True, nogil=True)
def solve(
    c: F64, z: F64, w: F64, first: I64, wx: F64, wy: F64, bend: float, slope: float, ridge: float, steps: int
) -> F64:
    """Coefficients after `steps` of preconditioned conjugate gradients from c."""
    diagonal = np.full_like(c, ridge + 28 * bend + 4 * slope)
    _spread(w, first, wx * wx, wy * wy, diagonal)
    r = -_apply(c, w, first, wx, wy, bend, slope, ridge)
    _spread(w * z, first, wx, wy, r)
    y = r / diagonal
    p = y.copy()
    rho = _dot(r, y)
    for _ in range(steps):
        if rho < 1e-18:
            break
        q = _apply(p, w, first, wx, wy, bend, slope, ridge)
        alpha = rho / _dot(p, q)
        c = c + alpha * p
        r = r - alpha * q
        y = r / diagonal
        rho, old = _dot(r, y), rho
        p = y + (rho / old) * p
    return c


@dataclass(frozen=True)
class Sheet:
    """A fitted sheet: knots' coefficients (k, k) and their spacing [m]."""

    c: F64
    cell: float

    def __call__(self, xy: F64) -> F64:
        """Height (n,) [m] over the plane at (n, 2) [m, sensor]; held constant outside its area."""
        return np.asarray(value(self.c, *basis(xy, self.cell, len(self.c))))


def flat_sheet(radius: float, cell: float) -> Sheet:
    """The plane itself: a sheet of height 0 that covers `radius` [m]."""
    knots = 2 * int(np.ceil(radius / cell)) + 3
    return Sheet(np.zeros((knots, knots)), cell)


def settle(sheet: Sheet, xy: F64, z: F64, weight: F64, rules: SheetRules, first: bool) -> Sheet:
    """The sheet drawn through the ground among lowest points, starting from `sheet`.

    Weights settle in rounds. The `first` time for the quantile 0.35, then robustly with a scale
    that shrinks to the noise; later with that scale only. Below counts more than above, since what
    is not ground stands above it.

    Args:
        xy: (n, 2) [m, sensor]. z: (n,) over the plane [m]. weight: (n,) 1 for an ordinary point.
    """
    parts = basis(xy, sheet.cell, len(sheet.c))
    c, s = sheet.c, rules.noise
    stiff = (s / rules.bend) ** 2, (s / rules.slope) ** 2, (s / RIDGE_STD) ** 2
    below = 1 - QUANTILE if rules.asymmetric else 0.5
    for scale in np.geomspace(1.0, s, QUANTILE_ROUNDS if first else 0):
        e = z - value(c, *parts)
        w = weight * np.where(e > 0, 1 - below, below) * s / np.hypot(e, scale)
        c = solve(c, z, w, *parts, *stiff, STEPS)
    for scale in np.geomspace(4 * s, s, ROBUST_ROUNDS) if first else (2 * s, s):
        e = z - value(c, *parts)
        u = np.where((e < 0) & rules.asymmetric, e / (3 * scale), e / scale)
        c = solve(c, z, weight / (1 + u * u) ** 2, *parts, *stiff, STEPS)
    return Sheet(c, sheet.cell)
