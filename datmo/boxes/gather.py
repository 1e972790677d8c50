"""The points of each cluster side by side, and the ground under them."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F64, I32, I64


@njit(cache=True, nogil=True)
def gather(points: F64, ground: F64, label: I32, count: int) -> tuple[F64, F64, I64]:
    """Points and ground of the clusters: rows `starts[k]:starts[k + 1]` are those of cluster k, in order.

    Args:
        points: (n, 3) [m]. ground: (n,) [m]. label: (n,) -1 none. count: number of clusters.

    Returns:
        points (m, 3), ground (m,) and starts (count + 1,).
    """
    starts = np.zeros(count + 1, np.int64)
    for i in range(len(label)):
        if label[i] >= 0:
            starts[label[i] + 1] += 1
    starts = np.cumsum(starts)
    gathered, below, place = np.empty((starts[-1], 3)), np.empty(starts[-1]), starts[:-1].copy()
    for i in range(len(label)):
        if label[i] >= 0:
            row = place[label[i]]
            gathered[row, 0], gathered[row, 1], gathered[row, 2] = points[i, 0], points[i, 1], points[i, 2]
            below[row] = ground[i]
            place[label[i]] = row + 1
    return gathered, below, starts


@njit(cache=True, nogil=True)
def first_bad(points: F64, ground: F64, label: I32) -> int:
    """Row of the first point with a label and a number, of its own or of its ground, that is not finite;
    -1 none.
    """
    for i in range(len(label)):
        if label[i] >= 0 and not np.isfinite(points[i, 0] + points[i, 1] + points[i, 2] + ground[i]):
            return i
    return -1


def heights(z: F64, ground: F64, starts: I64) -> tuple[F64, F64, F64]:
    """Mean ground and highest point of each cluster, and its lowest point above the ground (k,) [m].

    0 for a label without points.

    Args:
        z, ground: (m,) [m], cluster by cluster. starts: (k + 1,).
    """
    number = np.diff(starts)
    base, top, clearance = np.zeros((3, len(number)))
    held = np.flatnonzero(number)
    if len(held):
        base[held] = np.add.reduceat(ground, starts[held]) / number[held]
        top[held] = np.maximum.reduceat(z, starts[held])
        clearance[held] = np.minimum.reduceat(z - ground, starts[held])
    return base, top, clearance
