"""Hough transform: points vote for the lines through them (Alg. 11)."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, Array
from datmo.ground.lines.inliers import LEAST, claim
from datmo.ground.lines.table import JOIN, record_labels

ANGLES = 360
"""Cells over half a turn: 0.5 degrees each."""
OFFSETS = 1024
"""Most cells over the distance from the profile's middle; they are `join` wide while that suffices."""


@numba.njit(cache=True, nogil=True)
def _angle(cell: int) -> float:
    """Of a cell's middle [rad]; cell 0 is a vertical line."""
    return float(np.pi * (cell / ANGLES - 0.5))


@numba.njit(cache=True, nogil=True)
def _vote(r: float, z: float, turns: F64, step: float, by: int, votes: Array) -> None:
    """Add `by` to the cell of each angle's line through a point, (r, z) from the middle."""
    middle = votes.shape[1] // 2
    for t in range(ANGLES):
        offset = turns[t, 0] * z - turns[t, 1] * r
        votes[t, middle + int(np.floor(offset / step + 0.5))] += by


@numba.njit(cache=True, nogil=True)
def _peak(votes: Array) -> tuple[int, int, int]:
    """Angle, offset and votes of the first of the fullest cells."""
    best_t = best_o = most = 0
    for t in range(votes.shape[0]):
        for o in range(votes.shape[1]):
            if votes[t, o] > most:
                best_t, best_o, most = t, o, votes[t, o]
    return best_t, best_o, most


@numba.njit(cache=True, nogil=True)
def hough(r: F64, z: F64, rules: F64, draws: F64, lines: F64) -> int:  # noqa: ARG001
    """Fill `lines` with the lines of ordered points (n,); their number.

    A cell fixes the angle to within half its width only, so the first round of inliers fans out by
    that. The votes of a line's points are taken back before the next peak. `draws` is not used.
    """
    n, k, join = len(r), 0, rules[JOIN]
    label = np.full(n, -1, np.int32)
    if n < LEAST:
        return 0
    r0, z0, reach = 0.5 * (r[0] + r[n - 1]), z.sum() / n, join
    for i in range(n):
        reach = max(reach, np.hypot(r[i] - r0, z[i] - z0))
    step = max(join, 2.0 * reach / (OFFSETS - 3))
    votes = np.zeros((ANGLES, 2 * int(np.ceil(reach / step)) + 3), np.int16)
    turns = np.empty((ANGLES, 2))
    for t in range(ANGLES):
        turns[t, 0], turns[t, 1] = np.cos(_angle(t)), np.sin(_angle(t))
    for i in range(n):
        _vote(r[i] - r0, z[i] - z0, turns, step, 1, votes)
    while True:
        t, o, most = _peak(votes)
        if most < LEAST:
            break
        offset = (o - votes.shape[1] // 2) * step
        mr, mz = r0 - turns[t, 1] * offset, z0 + turns[t, 0] * offset
        if claim(r, z, label, k, _angle(t), mr, mz, join, 0.5 * np.pi / ANGLES) == 0:
            votes[t, o] = 0
            continue
        for i in range(n):
            if label[i] == k:
                _vote(r[i] - r0, z[i] - z0, turns, step, -1, votes)
        k += 1
    return int(record_labels(r, z, label, k, rules, lines))
