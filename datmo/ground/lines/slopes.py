"""The slope of the nearest line, which the length-scales of `z` come from (3.11)."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, I32, Bool
from datmo.ground.lines.extract import LineMethod, draw, extractor
from datmo.ground.lines.incremental import incremental
from datmo.ground.lines.table import COLUMNS, END, SLOPE, START
from datmo.threads import over_rows


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
def _incremental_slopes(
    r: F64,
    z: F64,
    present: Bool,
    at: F64,
    at_nodes: F64,
    count: I32,
    nodes: F64,
    rules: F64,
    default: float,
    none: F64,
) -> None:
    """Some segments in one kernel, for the extractor that the ground runs on."""
    M, N = r.shape
    rs, zs, lines, slopes = np.empty(N), np.empty(N), np.empty((N, COLUMNS)), np.empty(N)
    for m in range(M):
        n = 0
        for b in range(N):
            if present[m, b]:
                rs[n], zs[n] = r[m, b], z[m, b]
                n += 1
        count[m] = incremental(rs[:n], zs[:n], rules, none, lines)
        nearest_slope(nodes, lines, count[m], default, at_nodes[m])
        nearest_slope(rs[:n], lines, count[m], default, slopes)
        n = 0
        for b in range(N):
            if present[m, b]:
                at[m, b] = slopes[n]
                n += 1


def segment_slopes(
    r: F64,
    z: F64,
    present: Bool,
    nodes: F64,
    rules: F64,
    default: float,
    method: LineMethod = "incremental",
    rng: np.random.Generator | None = None,
) -> tuple[F64, F64, I32]:
    """Slopes of the nearest line at the candidates and at `nodes`, segment by segment.

    Every segment has the same random numbers, so that turning the cloud turns the result.

    Args:
        r, z: (M, N) candidates. present: (M, N). nodes: (Q,) [m]. rules: see `as_array`.
        default: slope of a segment without lines. method: a name of `EXTRACTORS`.
        rng: for the random methods; None takes one of a fixed seed.

    Returns:
        (M, N), (M, Q) |slope|, and the number of lines of each segment (M,).

    Raises:
        ConfigError: the method is not known.
    """
    find, draws = extractor(method), draw(method, rng)
    M, N = r.shape
    at, at_nodes, count = np.full((M, N), default), np.empty((M, len(nodes))), np.zeros(M, np.int32)
    if method == "incremental":
        over_rows(_incremental_slopes, (r, z, present, at, at_nodes, count), (nodes, rules, default, draws))
        return at, at_nodes, count
    lines = np.empty((N, COLUMNS))
    for m in range(M):
        rs = r[m, present[m]]
        found = np.empty(len(rs))
        count[m] = k = find(rs, z[m, present[m]], rules, draws, lines)
        nearest_slope(nodes, lines, k, default, at_nodes[m])
        nearest_slope(rs, lines, k, default, found)
        at[m, present[m]] = found
    return at, at_nodes, count
