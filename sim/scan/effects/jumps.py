"""Where the range image jumps: the edges between neighbouring rays."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, I32, Bool
from datmo.threads import groups, spread
from sim.scan.pattern import Pattern

JUMP, BEND = 0.1, 0.5
"""An edge steps this much [m], and this share of the steeper slope, out of the slopes beside it: so much
do rough grounds seen at grazing angles step without an edge."""
RINGS = 8
"""Rings a block."""


def shifts(pattern: Pattern) -> I32:
    """Columns (L,) by which each ring lags: ring i looks at column c + shifts[i] where a ring without
    correction of its azimuth looks at c."""
    return np.round(pattern.azimuth / (2 * np.pi / pattern.columns)).astype(np.int32)


@njit(cache=True, nogil=True)
def _steps(near: F32, far: F32, shift: int, out: F32) -> None:
    """Range [m] at column c + shift of one row less that at column c of another, 0 where one met nothing."""
    C = len(near)
    out[:] = 0.0
    for c in range(max(-shift, 0), min(C - shift, C)):
        step = far[c + shift] - near[c]
        out[c] = step if abs(step) < np.inf else np.float32(0)


@njit(cache=True, nogil=True)
def _jumps(gap: F32, before: F32, behind: F32, shift: tuple[int, int], out: Bool) -> None:
    """Whether each gap (C,) steps out of the slopes before and behind it, rows with shifts of their own.

    On a plane, or at a fold where two surfaces touch, none does.
    """
    C = len(gap)
    for c in range(C):
        i, j, one, other = c + shift[0], c + shift[1], np.float32(0), np.float32(0)
        if 0 <= i < C:
            one = before[i]
        if 0 <= j < C:
            other = behind[j]
        slack = np.float32(JUMP) + np.float32(BEND) * max(abs(one), abs(other))
        out[c] = gap[c] > max(one, other) + slack or gap[c] < min(one, other) - slack


@njit(cache=True, nogil=True)
def _edges(start: int, stop: int, distance: F32, lag: I32, edge: Bool) -> None:
    """Fill both kinds of edges (2, L, C) in rows start..stop, see `jumps`."""
    L, C = distance.shape
    across, down = np.empty(C, np.float32), np.zeros((stop - start + 2, C), np.float32)
    for i in range(max(start - 1, 0), min(stop + 1, L - 1)):  # a row of no step where there is none
        _steps(distance[i], distance[i + 1], lag[i + 1] - lag[i], down[i - start + 1])
    for i in range(start, stop):
        _steps(distance[i], distance[i], 1, across)
        _jumps(across, across, across, (-1, 1), edge[0, i])
        if i + 1 < L:
            shift, row = (lag[max(i - 1, 0)] - lag[i], lag[i + 1] - lag[i]), i - start
            _jumps(down[row + 1], down[row], down[row + 2], shift, edge[1, i])


def jumps(distance: F32, lag: I32) -> tuple[Bool, Bool]:
    """Edges of a range image (L, C) [m], infinite where a ray met nothing.

    Args:
        lag: (L,) see `shifts`.

    Returns:
        (L, C) each: an edge before the next column of the ring; before the ray of the next ring that
        looks the same way.
    """
    edge = np.zeros((2, *distance.shape), np.bool_)
    spread(lambda s: _edges(s.start, s.stop, distance, lag, edge), groups(len(distance), RINGS))
    return edge[0], edge[1]


def beside(edge: tuple[Bool, Bool], lag: I32) -> Bool:
    """Which rays (L, C) have an edge on some side.

    Args:
        edge: of `jumps`. lag: (L,) see `shifts`.
    """
    across, down = edge
    found, C = across | down, across.shape[1]
    found[:, 1:] |= across[:, :-1]
    for i, shift in enumerate(np.diff(lag)):
        first, last = max(-shift, 0), min(C - shift, C)
        found[i + 1, first + shift : last + shift] |= down[i, first:last]
    return np.asarray(found)
