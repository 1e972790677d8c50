"""Expectation-maximisation: lines that weigh the points by how well they fit (Alg. 12)."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, I32
from datmo.ground.lines.inliers import LEAST, claim, free_points, inlier, longest_run
from datmo.ground.lines.table import JOIN, fit_weighted, record_labels

TRIALS, STEPS = 16, 20
REACH = 12
"""A first guess goes through two free points so many apart at most."""
COOL = 0.7
CONVERGED = 1e-5


@numba.njit(cache=True, nogil=True)
def _settle(
    r: F64, z: F64, label: I32, angle: float, mr: float, mz: float, join: float, weight: F64
) -> tuple[float, float, float]:
    """E and M steps in turn until the line stands still: angle, and a point of it.

    E: weight of a point is g / (g + g(3 σ)), g = exp(-d² / 2σ²): an outlier beyond `join` = 3 σ. The
    first steps have a wider σ. M: weighted total least squares.
    """
    floor = np.exp(-4.5)
    for step in range(STEPS):
        sigma = max(join * COOL**step, join / 3)
        c, s = np.cos(angle), np.sin(angle)
        total = 0.0
        for i in range(len(r)):
            d = (c * (z[i] - mz) - s * (r[i] - mr)) / sigma
            g = np.exp(-0.5 * d * d)
            weight[i] = g / (g + floor) if label[i] < 0 else 0.0
            total += weight[i]
        if total < 1.0:
            break
        before = angle
        angle, mr, mz = fit_weighted(r, z, weight)
        if abs(angle - before) < CONVERGED and sigma <= join / 3:
            break
    return angle, mr, mz


@numba.njit(cache=True, nogil=True)
def em(r: F64, z: F64, rules: F64, draws: F64, lines: F64) -> int:
    """Fill `lines` with the lines of ordered points (n,); their number.

    The best of TRIALS is stored, its inliers are removed, and so on until the best has too few.
    """
    n, k, drawn, join = len(r), 0, 0, rules[JOIN]
    label, free, inside = np.full(n, -1, np.int32), np.empty(n, np.int32), np.zeros(n, np.bool_)
    weight = np.empty(n)
    while True:
        m = free_points(label, free)
        if m < LEAST:
            break
        most, best, best_r, best_z = 0, 0.0, 0.0, 0.0
        for _ in range(TRIALS):
            i = int(draws[drawn % len(draws)] * (m - 1))
            j = min(i + 1 + int(draws[(drawn + 1) % len(draws)] * REACH), m - 1)
            drawn += 2
            a, b = free[i], free[j]
            guess = np.arctan2(z[b] - z[a], r[b] - r[a])
            angle, mr, mz = _settle(r, z, label, guess, r[a], z[a], join, weight)
            inlier(r, z, label, angle, mr, mz, join, 0.0, inside)
            count = longest_run(inside)[2]
            if count > most:
                most, best, best_r, best_z = count, angle, mr, mz
        if most < LEAST or claim(r, z, label, k, best, best_r, best_z, join, 0.0) == 0:
            break
        k += 1
    return int(record_labels(r, z, label, k, rules, lines))
