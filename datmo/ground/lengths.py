"""The length of the line that a place of a segment belongs to: the mean of zl's length-scales."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, I32, Bool
from datmo.ground.lines import END, START
from datmo.ground.lines.incremental import incremental
from datmo.ground.lines.table import COLUMNS
from datmo.threads import over_rows

SHORTEST, LONGEST = 1.0, 40.0
NO_DRAWS = np.empty(0)


def log_lengths(
    r: F64, z: F64, present: Bool, nodes: F64, rules: F64, default: float
) -> tuple[F64, F64, I32]:
    """Log length [log m] of the line at the cells (M, N) and at `nodes` (M, Q); number of lines (M,).

    On a line its own length, held within 1 and 40 m; between two lines interpolated over r, beyond
    the first and the last held; log `default` in a segment without lines.

    Args:
        r, z: (M, N) ordered by r. present: (M, N). nodes: (Q,) [m]. rules: of `as_array`.
    """
    M, N = r.shape
    at, at_nodes = np.full((M, N), np.log(default)), np.full((M, len(nodes)), np.log(default))
    count = np.zeros(M, np.int32)
    over_rows(_log_lengths, (r, z, present, at, at_nodes, count), (nodes, rules))
    return at, at_nodes, count


@numba.njit(cache=True, nogil=True)
def _log_lengths(
    r: F64, z: F64, present: Bool, at: F64, at_nodes: F64, count: I32, nodes: F64, rules: F64
) -> None:
    """Some segments: writes at, at_nodes and count where they have lines."""
    N = r.shape[1]
    lines, ends, logs = np.empty((N, COLUMNS)), np.empty(2 * N), np.empty(2 * N)
    for m in range(len(r)):
        seen = np.flatnonzero(present[m])
        k = incremental(r[m][seen], z[m][seen], rules, NO_DRAWS, lines)
        count[m] = k
        if k == 0:
            continue
        for j in range(k):
            ends[2 * j], ends[2 * j + 1] = lines[j, START], lines[j, END]
            length = min(max(lines[j, END] - lines[j, START], SHORTEST), LONGEST)
            logs[2 * j] = logs[2 * j + 1] = np.log(length)
        at[m] = np.interp(r[m], ends[: 2 * k], logs[: 2 * k])
        at_nodes[m] = np.interp(nodes, ends[: 2 * k], logs[: 2 * k])
