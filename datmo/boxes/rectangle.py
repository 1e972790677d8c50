"""Search-based rectangle fitting (Zhang, Xu, Dong, Dolan: Efficient L-shape fitting, IV 2017).

For each angle in [0, pi/2) the outline is projected on the two axes of a rectangle and scored; the
first angle with the best score wins.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F64, I64

AREA, CLOSENESS, SQUARED_ERROR = 0, 1, 2


def search(
    outline: F64, length: I64, step: float, nearest: float, criterion: str, weights: tuple[float, ...]
) -> F64:
    """Angle (k,) of the best rectangle around each outline [rad, 0 <= angle < pi/2].

    Args:
        outline: (k, m, 2) [m], of which `length` (k,) rows count.
        step: between two angles [rad].
        nearest: least distance to an edge in the closeness criterion [m].
        criterion: "area", "closeness", "squared_error" or "weighted".
        weights: of the three in "weighted".
    """
    angles = np.arange(0, np.pi / 2 - 1e-9, step)
    one_hot = {"area": (1, 0, 0), "closeness": (0, 1, 0), "squared_error": (0, 0, 1)}
    chosen = np.array(weights if criterion == "weighted" else one_hot[criterion], float)
    return np.asarray(angles[_search(outline, length, np.cos(angles), np.sin(angles), nearest, chosen)])


@njit(cache=True, nogil=True)
def extents(xy: F64, starts: I64, angle: F64) -> F64:
    """Least and largest coordinate (k, 4): x0, x1, y0, y1 of each cluster along axes at its angle.

    Args:
        xy: (n, 2 or more) [m], cluster by cluster. starts: (k + 1,). angle: (k,) [rad].
    """
    out = np.zeros((len(angle), 4))
    for k in range(len(angle)):
        c, s = np.cos(angle[k]), np.sin(angle[k])
        for i in range(starts[k], starts[k + 1]):
            x, y = c * xy[i, 0] + s * xy[i, 1], c * xy[i, 1] - s * xy[i, 0]
            first = i == starts[k]
            out[k, 0] = x if first else min(out[k, 0], x)
            out[k, 1] = x if first else max(out[k, 1], x)
            out[k, 2] = y if first else min(out[k, 2], y)
            out[k, 3] = y if first else max(out[k, 3], y)
    return out


@njit(cache=True, nogil=True)
def _search(outline: F64, length: I64, cos: F64, sin: F64, nearest: float, weights: F64) -> I64:
    best = np.zeros(len(outline), np.int64)
    score = np.zeros((3, len(cos)))
    scratch = np.empty((2, outline.shape[1]))
    for k in range(len(outline)):
        points = outline[k, : length[k]]
        to_x, to_y = scratch[0, : length[k]], scratch[1, : length[k]]
        for a in range(len(cos)):
            extent_x = _to_edge(points, cos[a], sin[a], to_x)
            extent_y = _to_edge(points, -sin[a], cos[a], to_y)
            if weights[AREA] != 0:
                score[AREA, a] = -extent_x * extent_y
            if weights[CLOSENESS] != 0:
                score[CLOSENESS, a] = _closeness(to_x, to_y, nearest)
            if weights[SQUARED_ERROR] != 0:
                score[SQUARED_ERROR, a] = -_squared_error(to_x, to_y) - _squared_error(to_y, to_x, True)
        total = np.zeros(len(cos))
        for c in range(3):
            spread = score[c].max() - score[c].min()
            if weights[c] != 0 and spread > 0:  # each criterion on its own scale, 0 worst .. 1 best
                total += weights[c] * (score[c] - score[c].min()) / spread
        best[k] = np.argmax(total)
    return best


@njit(cache=True, nogil=True)
def _to_edge(points: F64, u: float, v: float, distance: F64) -> float:
    """Project on the axis (u, v); fill in the distances to the edge that is nearer on the whole.

    Returns the extent along the axis.
    """
    low, high = np.inf, -np.inf
    for i in range(len(points)):
        distance[i] = u * points[i, 0] + v * points[i, 1]
        low, high = min(low, distance[i]), max(high, distance[i])
    to_low, to_high = 0.0, 0.0
    for i in range(len(points)):
        to_low += (distance[i] - low) ** 2
        to_high += (high - distance[i]) ** 2
    for i in range(len(points)):
        distance[i] = high - distance[i] if to_high < to_low else distance[i] - low
    return max(high - low, 0.0)


@njit(cache=True, nogil=True)
def _closeness(to_x: F64, to_y: F64, nearest: float) -> float:
    total = 0.0
    for i in range(len(to_x)):
        total += 1 / max(min(to_x[i], to_y[i]), nearest)
    return total


@njit(cache=True, nogil=True)
def _squared_error(to_a: F64, to_b: F64, ties: bool = False) -> float:
    """Mean squared residual of the line fitted to the points nearer to edge a: their variance."""
    n, mean, square = 0, 0.0, 0.0
    for i in range(len(to_a)):
        if to_a[i] < to_b[i] or (ties and to_a[i] == to_b[i]):
            n += 1
            mean += to_a[i]
    if n == 0:
        return 0.0
    mean /= n
    for i in range(len(to_a)):
        if to_a[i] < to_b[i] or (ties and to_a[i] == to_b[i]):
            square += (to_a[i] - mean) ** 2
    return square / n
