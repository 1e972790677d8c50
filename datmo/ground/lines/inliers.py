"""What the searching extractors share: the run of a line's inliers, and their removal."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, I32, Bool
from datmo.ground.lines.table import fit_weighted

LEAST = 4
"""Fewer inliers make no line."""
HOLE = 4
"""A line ends where more points in a row than this are not its inliers."""
ROUNDS = 3


@numba.njit(cache=True, nogil=True)
def longest_run(inside: Bool) -> tuple[int, int, int]:
    """Of the points (n,) inside, the most without a hole larger than HOLE: first, last, how many.

    The profile is ordered, and so a line is one stretch of it. Inliers elsewhere lie there by chance.
    """
    first = last = start = end = -1
    most = count = 0
    for i in range(len(inside)):
        if not inside[i]:
            continue
        if end < 0 or i - end > HOLE + 1:
            start, count = i, 0
        end = i
        count += 1
        if count > most:
            first, last, most = start, end, count
    return first, last, most


@numba.njit(cache=True, nogil=True)
def inlier(
    r: F64, z: F64, label: I32, angle: float, mr: float, mz: float, join: float, fan: float, inside: Bool
) -> None:
    """Mark the free points within `join` [m] of a line, and `fan` [m/m] more along it, in `inside`."""
    c, s = np.cos(angle), np.sin(angle)
    for i in range(len(r)):
        u, v = r[i] - mr, z[i] - mz
        inside[i] = label[i] < 0 and abs(c * v - s * u) <= join + fan * abs(c * u + s * v)


@numba.njit(cache=True, nogil=True)
def claim(
    r: F64, z: F64, label: I32, k: int, angle: float, mr: float, mz: float, join: float, fan: float
) -> int:
    """Recompute a line from its longest run of inliers and give that run label k; how many it took.

    Args:
        fan: extra width of the first round [m/m], for a line known to within an angle.

    Returns:
        0 where fewer than LEAST are left; nothing is labelled then.
    """
    inside, weight = np.zeros(len(r), np.bool_), np.zeros(len(r))
    count = 0
    for turn in range(ROUNDS):
        inlier(r, z, label, angle, mr, mz, join, fan if turn == 0 else 0.0, inside)
        first, last, count = longest_run(inside)
        if count < LEAST:
            return 0
        for i in range(len(r)):
            inside[i] = inside[i] and first <= i <= last
            weight[i] = 1.0 if inside[i] else 0.0
        angle, mr, mz = fit_weighted(r, z, weight)
    for i in range(len(r)):
        if inside[i]:
            label[i] = k
    return count


@numba.njit(cache=True, nogil=True)
def free_points(label: I32, free: I32) -> int:
    """Write the indices of the points without a label into `free` (n,); how many."""
    m = 0
    for i in range(len(label)):
        if label[i] < 0:
            free[m] = i
            m += 1
    return m
