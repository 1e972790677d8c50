"""Convex hull by Andrew's monotone chain, and the rectangle of least area around it."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F64, I64


@njit(cache=True, nogil=True)
def convex_hull(points: F64) -> F64:
    """Corners (h, 2) of the hull of points (n, 2), counter-clockwise from the lowest x (then y).

    Points on an edge are left out. Collinear points give the two ends, equal points give one.
    """
    n = len(points)
    order = np.argsort(points[:, 1], kind="mergesort")
    order = order[np.argsort(points[order, 0], kind="mergesort")]
    hull = np.empty((2 * n + 1, 2))
    size = 0
    for i in range(n):  # lower chain
        size = _push(hull, size, 2, points[order[i]])
    floor = size + 1
    for i in range(n - 2, -1, -1):  # upper chain
        size = _push(hull, size, floor, points[order[i]])
    if size > 1:
        size -= 1  # the last point is the first
    if size == 2 and hull[0, 0] == hull[1, 0] and hull[0, 1] == hull[1, 1]:
        size = 1
    return hull[:size].copy()


@njit(cache=True, nogil=True)
def _push(hull: F64, size: int, floor: int, p: F64) -> int:
    """Add p to a chain, dropping the corners that it makes straight or hollow; the new size."""
    while size >= floor:
        a, b = hull[size - 2], hull[size - 1]
        if (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0:
            break
        size -= 1
    hull[size] = p
    return size + 1


@njit(cache=True, nogil=True)
def least_area_angles(xy: F64, starts: I64) -> F64:
    """Angle (k,) of the rectangle of least area around each cluster [rad, 0 <= angle < pi/2].

    It lies along an edge of the hull (Freeman and Shapira 1975), so every edge is tried.

    Args:
        xy: (n, 2) [m], cluster by cluster. starts: (k + 1,).
    """
    angles = np.zeros(len(starts) - 1)
    for k in range(len(angles)):
        hull = convex_hull(xy[starts[k] : starts[k + 1]])
        least = np.inf
        for i in range(len(hull)):
            j = (i + 1) % len(hull)
            angle = np.arctan2(hull[j, 1] - hull[i, 1], hull[j, 0] - hull[i, 0]) % (np.pi / 2)
            if angle >= np.pi / 2:  # the remainder of -1e-17 is the divisor itself
                angle = 0.0
            c, s = np.cos(angle), np.sin(angle)
            x, y = c * hull[:, 0] + s * hull[:, 1], c * hull[:, 1] - s * hull[:, 0]
            area = (x.max() - x.min()) * (y.max() - y.min())
            if area < least:
                least, angles[k] = area, angle
    return angles
