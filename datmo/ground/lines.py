"""Incremental line extraction on the ordered candidates of a segment (3.6, Alg. 1, corrected)."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, I32, Bool

START, END, SLOPE, INTERCEPT, RMSE, COUNT, GROUND = range(7)


@dataclass(frozen=True)
class LineRules:
    """When a point joins a line and when a line is ground; defaults and names as in the config."""

    join: float = 0.15
    turn: float = 0.02
    slope_max: float = 0.3
    rmse: float = 0.1
    small: float = 0.02
    intercept: float = 0.5


@numba.njit(cache=True, nogil=True)
def _angle(r: F64, z: F64, a: int, b: int) -> tuple[float, float, float, float]:
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
def _record(r: F64, z: F64, a: int, b: int, small: float, rules: F64, line: F64) -> None:
    """Write the line through points a..b-1 and whether it is ground."""
    angle, mr, mz, rmse = _angle(r, z, a, b)
    slope = np.tan(angle)
    intercept = mz - slope * mr
    flat_off = abs(slope) < small and abs(intercept) > rules[5]
    line[START], line[END], line[SLOPE], line[INTERCEPT] = r[a], r[b - 1], slope, intercept
    line[RMSE], line[COUNT] = rmse, b - a
    line[GROUND] = abs(slope) <= rules[2] and rmse <= rules[3] and not flat_off


@numba.njit(cache=True, nogil=True)
def _extract(r: F64, z: F64, n: int, rules: F64, lines: F64) -> int:
    """Lines of the first n ordered points into `lines`; their number."""
    a, k = 0, 0
    angle, mr, mz = 0.0, 0.0, 0.0
    for b in range(1, n + 1):
        if b < n and b - a >= 2:
            off = abs(-np.sin(angle) * (r[b] - mr) + np.cos(angle) * (z[b] - mz))
            turned, mr2, mz2, rmse = _angle(r, z, a, b + 1)
            # The angle of a short line is uncertain by about its scatter over its length.
            allowed = rules[1] + 2 * rules[3] / max(r[b] - r[a], 1e-6)
            joins = off <= rules[0] and abs(turned - angle) <= allowed and rmse <= rules[3]
            if joins:
                angle, mr, mz = turned, mr2, mz2
                continue
        elif b < n:
            angle, mr, mz, _ = _angle(r, z, a, b + 1)
            continue
        if b - a >= 2:
            _record(r, z, a, b, rules[4], rules, lines[k])
            k += 1
        a = b
    return k


@numba.njit(cache=True, nogil=True)
def nearest_slope(query: F64, lines: F64, k: int, default: float, out: F64) -> None:
    """|slope| of the line nearest to each query along r (3.11); `default` without lines."""
    for i in range(len(query)):
        best = np.inf
        out[i] = default
        for j in range(k):
            gap = max(lines[j, START] - query[i], query[i] - lines[j, END], 0.0)
            if gap < best:
                best, out[i] = gap, abs(lines[j, SLOPE])


@numba.njit(cache=True, nogil=True)
def segment_slopes(
    r: F64, z: F64, present: Bool, nodes: F64, rules: F64, default: float
) -> tuple[F64, F64, I32]:
    """Slopes of the nearest line at the candidates and at `nodes`, segment by segment.

    Args:
        r, z: (M, N) candidates. present: (M, N). nodes: (Q,) [m].

    Returns:
        (M, N), (M, Q) |slope|, and the number of lines of each segment (M,).
    """
    M, N = r.shape
    at, at_nodes, count = np.full((M, N), default), np.empty((M, len(nodes))), np.zeros(M, np.int32)
    rs, zs, lines, slopes = np.empty(N), np.empty(N), np.empty((N, 7)), np.empty(N)
    for m in range(M):
        n = 0
        for b in range(N):
            if present[m, b]:
                rs[n], zs[n] = r[m, b], z[m, b]
                n += 1
        count[m] = _extract(rs, zs, n, rules, lines)
        nearest_slope(nodes, lines, count[m], default, at_nodes[m])
        nearest_slope(rs[:n], lines, count[m], default, slopes)
        n = 0
        for b in range(N):
            if present[m, b]:
                at[m, b] = slopes[n]
                n += 1
    return at, at_nodes, count


def as_array(rules: LineRules) -> F64:
    """The rules in the order that the kernels read them."""
    return np.array([rules.join, rules.turn, rules.slope_max, rules.rmse, rules.small, rules.intercept])


def extract_lines(r: F64, z: F64, rules: LineRules | None = None) -> F64:
    """Lines of one segment by Alg. 1.

    A line grows point by point; when the point lies off it, turns it or spoils its fit, the line is
    kept without that point and a new one starts there.

    Args:
        r, z: (n,) [m], ordered by r.

    Returns:
        (k, 7): start and end [m], slope [m/m], intercept [m], rmse [m], number of points, and 1
        where the line is ground.
    """
    r, z = np.asarray(r, float), np.asarray(z, float)
    lines = np.empty((len(r), 7))
    k = _extract(r, z, len(r), as_array(rules or LineRules()), lines)
    return lines[:k]
