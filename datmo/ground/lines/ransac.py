"""RANSAC: lines through two random points, the one with most inliers first (Alg. 15)."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64
from datmo.ground.lines.inliers import LEAST, claim, free_points, inlier, longest_run
from datmo.ground.lines.table import JOIN, record_labels

TRIALS = 60


@numba.njit(cache=True, nogil=True)
def ransac(r: F64, z: F64, rules: F64, draws: F64, lines: F64) -> int:
    """Fill `lines` with the lines of ordered points (n,); their number.

    Alg. 15 stores the first sample with enough inliers. This one stores the best of TRIALS, counts
    only inliers in one run, and ends when the best has too few.
    """
    n, k, drawn = len(r), 0, 0
    label, free, inside = np.full(n, -1, np.int32), np.empty(n, np.int32), np.zeros(n, np.bool_)
    while True:
        m = free_points(label, free)
        if m < LEAST:
            break
        most, angle, mr, mz = 0, 0.0, 0.0, 0.0
        for _ in range(TRIALS):
            i = int(draws[drawn % len(draws)] * m)
            j = (i + 1 + int(draws[(drawn + 1) % len(draws)] * (m - 1))) % m
            drawn += 2
            a, b = free[min(i, j)], free[max(i, j)]
            turned = np.arctan2(z[b] - z[a], r[b] - r[a])
            inlier(r, z, label, turned, r[a], z[a], rules[JOIN], 0.0, inside)
            count = longest_run(inside)[2]
            if count > most:
                most, angle, mr, mz = count, turned, r[a], z[a]
        if most < LEAST or claim(r, z, label, k, angle, mr, mz, rules[JOIN], 0.0) == 0:
            break
        k += 1
    return int(record_labels(r, z, label, k, rules, lines))
