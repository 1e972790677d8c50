"""Incremental line extraction on the ordered candidates of a segment (3.6, Alg. 1, corrected; Alg. 14)."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64
from datmo.ground.lines.table import JOIN, MOST_RMSE, TURN, fit, record


@numba.njit(cache=True, nogil=True)
def incremental(r: F64, z: F64, rules: F64, draws: F64, lines: F64) -> int:  # noqa: ARG001
    """Fill `lines` with the lines of ordered points (n,); their number. `draws` is not used.

    A line grows point by point; when the point lies off it, turns it or spoils its fit, the line is
    kept without that point and a new one starts there.
    """
    n, a, k = len(r), 0, 0
    angle, mr, mz = 0.0, 0.0, 0.0
    for b in range(1, n + 1):
        if b < n and b - a >= 2:
            off = abs(-np.sin(angle) * (r[b] - mr) + np.cos(angle) * (z[b] - mz))
            turned, mr2, mz2, rmse = fit(r, z, a, b + 1)
            # The angle of a short line is uncertain by about its scatter over its length.
            allowed = rules[TURN] + 2 * rules[MOST_RMSE] / max(r[b] - r[a], 1e-6)
            joins = off <= rules[JOIN] and abs(turned - angle) <= allowed and rmse <= rules[MOST_RMSE]
            if joins:
                angle, mr, mz = turned, mr2, mz2
                continue
        elif b < n:
            angle, mr, mz, _ = fit(r, z, a, b + 1)
            continue
        if b - a >= 2:
            record(r, z, a, b, rules, lines[k])
            k += 1
        a = b
    return k
