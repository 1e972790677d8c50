"""The table of lines that every extractor fills, the rules, and total least squares (3.6).

Numba's cache of an extractor does not see an edit of these kernels: clear it after one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, I32

START, END, SLOPE, INTERCEPT, RMSE, COUNT, GROUND = range(7)
COLUMNS = 7


@dataclass(frozen=True)
class LineRules:
    """When a point joins a line and when a line is ground; defaults and names as in the config."""

    join: float = 0.15
    turn: float = 0.02
    slope_max: float = 0.3
    rmse: float = 0.1
    small: float = 0.02
    intercept: float = 0.5


JOIN, TURN, SLOPE_MAX, MOST_RMSE, SMALL, MOST_INTERCEPT = range(6)


def as_array(rules: LineRules) -> F64:
    """The rules in the order that the kernels read them."""
    return np.array([rules.join, rules.turn, rules.slope_max, rules.rmse, rules.small, rules.intercept])


@numba.njit(cache=True, nogil=True)
def fit(r: F64, z: F64, a: int, b: int) -> tuple[float, float, float, float]:
    """Centred total least squares of points a..b-1: angle, mean r, mean z, rmse (3.6)."""
    n = b - a
    mr, mz = r[a:b].sum() / n, z[a:b].sum() / n
    rr = rz = zz = 0.0
    for i in range(a, b):
        u, v = r[i] - mr, z[i] - mz
        rr += u * u
        rz += u * v
        zz += v * v
    spread = np.hypot(rr - zz, 2 * rz)
    smallest = max(0.5 * (rr + zz - spread), 0.0)
    return 0.5 * np.arctan2(2 * rz, rr - zz), mr, mz, np.sqrt(smallest / n)


@numba.njit(cache=True, nogil=True)
def fit_weighted(r: F64, z: F64, weight: F64) -> tuple[float, float, float]:
    """The same with weights (n,), not all 0: angle, mean r, mean z."""
    total = mr = mz = 0.0
    for i in range(len(r)):
        total += weight[i]
        mr += weight[i] * r[i]
        mz += weight[i] * z[i]
    mr, mz = mr / total, mz / total
    rr = rz = zz = 0.0
    for i in range(len(r)):
        u, v = r[i] - mr, z[i] - mz
        rr += weight[i] * u * u
        rz += weight[i] * u * v
        zz += weight[i] * v * v
    return 0.5 * np.arctan2(2 * rz, rr - zz), mr, mz


@numba.njit(cache=True, nogil=True)
def record(r: F64, z: F64, a: int, b: int, rules: F64, line: F64) -> None:
    """Write the line through points a..b-1 and whether it is ground."""
    angle, mr, mz, rmse = fit(r, z, a, b)
    slope = np.tan(angle)
    intercept = mz - slope * mr
    flat_off = abs(slope) < rules[SMALL] and abs(intercept) > rules[MOST_INTERCEPT]
    line[START], line[END], line[SLOPE], line[INTERCEPT] = r[a], r[b - 1], slope, intercept
    line[RMSE], line[COUNT] = rmse, b - a
    line[GROUND] = abs(slope) <= rules[SLOPE_MAX] and rmse <= rules[MOST_RMSE] and not flat_off


@numba.njit(cache=True, nogil=True)
def record_labels(r: F64, z: F64, label: I32, k: int, rules: F64, lines: F64) -> int:
    """Write a line for each label 0..k-1 that two points (n,) or more have, by START; their number."""
    n, made = len(r), 0
    rs, zs = np.empty(n), np.empty(n)
    for j in range(k):
        m = 0
        for i in range(n):
            if label[i] == j:
                rs[m], zs[m] = r[i], z[i]
                m += 1
        if m < 2:
            continue
        record(rs, zs, 0, m, rules, lines[made])
        at = made
        while at > 0 and lines[at, START] < lines[at - 1, START]:
            for c in range(COLUMNS):
                lines[at, c], lines[at - 1, c] = lines[at - 1, c], lines[at, c]
            at -= 1
        made += 1
    return made
