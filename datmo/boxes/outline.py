"""The outline of a cluster: in each direction from the sensor, the nearest point."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F64, I64


@njit(cache=True, nogil=True)
def outlines(xy: F64, starts: I64, sensor_xy: F64, most: int, step: float) -> tuple[F64, I64]:
    """Nearest point of each cluster in each azimuth bin, seen from the sensor.

    The bins divide the azimuth that the cluster spans; they are `step` [rad] wide, wider where
    that makes more than `most`. The result does not depend on the order of the points.

    Args:
        xy: (n, 2 or more) [m], cluster by cluster. starts: (k + 1,). sensor_xy: (2,) [m].

    Returns:
        outline (k, most, 2), by azimuth, and the number of points of each (k,).
    """
    count = len(starts) - 1
    outline = np.zeros((count, most, 2))
    length = np.zeros(count, np.int64)
    for k in range(count):
        points = xy[starts[k] : starts[k + 1]]
        if len(points):
            length[k] = _outline(points, sensor_xy, step, outline[k])
    return outline, length


@njit(cache=True, nogil=True)
def _outline(points: F64, sensor_xy: F64, step: float, outline: F64) -> int:
    """Fill `outline` (most, 2); returns how many rows it takes."""
    most = len(outline)
    # Azimuth is counted from the middle of the cluster, so that it does not wrap within it.
    ahead_x = (points[:, 0].min() + points[:, 0].max()) / 2 - sensor_xy[0]
    ahead_y = (points[:, 1].min() + points[:, 1].max()) / 2 - sensor_xy[1]
    if ahead_x == 0 and ahead_y == 0:
        ahead_x = 1.0
    dx, dy = points[:, 0] - sensor_xy[0], points[:, 1] - sensor_xy[1]
    azimuth = np.arctan2(ahead_x * dy - ahead_y * dx, ahead_x * dx + ahead_y * dy)
    low = azimuth.min()
    width = max(step, (azimuth.max() - low) / most)
    best = np.full(most, -1, np.int64)
    for i in range(len(points)):
        b = min(int((azimuth[i] - low) / width), most - 1)
        j = best[b]
        if j < 0 or _before(dx, dy, i, j):
            best[b] = i
    n = 0
    for b in range(most):
        if best[b] >= 0:
            outline[n, 0], outline[n, 1] = points[best[b], 0], points[best[b], 1]
            n += 1
    return n


@njit(cache=True, nogil=True)
def _before(dx: F64, dy: F64, i: int, j: int) -> bool:
    """Whether point i is nearer than j; equal ranges are told apart by place, not by order."""
    a, b = dx[i] * dx[i] + dy[i] * dy[i], dx[j] * dx[j] + dy[j] * dy[j]
    if a != b:
        return bool(a < b)
    return bool((dx[i], dy[i]) < (dx[j], dy[j]))
