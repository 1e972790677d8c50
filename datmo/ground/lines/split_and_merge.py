"""Split and merge: halve at the farthest point, then join what is collinear (Alg. 10)."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, I32
from datmo.ground.lines.table import JOIN, MOST_RMSE, TURN, fit, record_labels

KERNEL = 3
"""Of two pieces that are joined, one has at least so many points."""


@numba.njit(cache=True, nogil=True)
def _farthest(r: F64, z: F64, a: int, b: int, angle: float, r0: float, z0: float) -> tuple[int, float]:
    """The point of a..b-1 farthest from a line, and its distance [m]."""
    c, s = np.cos(angle), np.sin(angle)
    at, most = a, -1.0
    for i in range(a, b):
        off = abs(c * (z[i] - z0) - s * (r[i] - r0))
        if off > most:
            at, most = i, off
    return at, most


@numba.njit(cache=True, nogil=True)
def _split(r: F64, z: F64, join: float, cuts: I32) -> int:
    """Write the first points of the pieces, and n behind them, into `cuts` (n + 1,); how many pieces.

    The line of a piece is the chord of its ends (iterative end-point fit): the farthest point from a
    fitted line may be an end, where nothing is halved.
    """
    n, k, a = len(r), 0, 0
    ends, top = np.empty(n + 1, np.int32), 0
    ends[0] = n
    while top >= 0:
        b = ends[top]
        angle = np.arctan2(z[b - 1] - z[a], r[b - 1] - r[a])
        at, off = _farthest(r, z, a, b, angle, r[a], z[a])
        if off > join and a < at < b - 1:
            top += 1
            ends[top] = at
            continue
        cuts[k] = a
        k += 1
        a = b
        top -= 1
    cuts[k] = n
    return k


@numba.njit(cache=True, nogil=True)
def _turned(r: F64, z: F64, a: int, b: int, angle: float, rules: F64) -> bool:
    """Whether the line through a..b-1 turns to `angle` by more than its length leaves uncertain."""
    if b - a < KERNEL:
        return False
    allowed = rules[TURN] + 2 * rules[MOST_RMSE] / max(r[b - 1] - r[a], 1e-6)
    return bool(abs(fit(r, z, a, b)[0] - angle) > allowed)


@numba.njit(cache=True, nogil=True)
def _joined(r: F64, z: F64, a: int, m: int, b: int, rules: F64) -> float:
    """Rmse [m] of the line through a..b-1 if pieces a..m-1 and m..b-1 are collinear, else inf."""
    if max(m - a, b - m) < KERNEL:
        return np.inf
    angle, mr, mz, rmse = fit(r, z, a, b)
    if rmse > rules[MOST_RMSE] or _farthest(r, z, a, b, angle, mr, mz)[1] > rules[JOIN]:
        return np.inf
    if _turned(r, z, a, m, angle, rules) or _turned(r, z, m, b, angle, rules):
        return np.inf
    return float(rmse)


@numba.njit(cache=True, nogil=True)
def _merge(r: F64, z: F64, rules: F64, cuts: I32, k: int) -> int:
    """Join the best-fitting two neighbours, again and again, in `cuts`; how many pieces are left."""
    cost = np.empty(k)
    for j in range(k - 1):
        cost[j] = _joined(r, z, cuts[j], cuts[j + 1], cuts[j + 2], rules)
    while k > 1:
        best = 0
        for j in range(1, k - 1):
            if cost[j] < cost[best]:
                best = j
        if cost[best] == np.inf:
            break
        k -= 1
        for j in range(best + 1, k + 1):
            cuts[j] = cuts[j + 1]
            cost[j - 1] = cost[j]
        for j in range(max(best - 1, 0), min(best + 1, k - 1)):
            cost[j] = _joined(r, z, cuts[j], cuts[j + 1], cuts[j + 2], rules)
    return k


@numba.njit(cache=True, nogil=True)
def split_and_merge(r: F64, z: F64, rules: F64, draws: F64, lines: F64) -> int:  # noqa: ARG001
    """Fill `lines` with the lines of ordered points (n,); their number. `draws` is not used."""
    n = len(r)
    if n < 2:
        return 0
    cuts, label = np.empty(n + 1, np.int32), np.empty(n, np.int32)
    k = _merge(r, z, rules, cuts, _split(r, z, rules[JOIN], cuts))
    for j in range(k):
        for i in range(cuts[j], cuts[j + 1]):
            label[i] = j
    return int(record_labels(r, z, label, k, rules, lines))
