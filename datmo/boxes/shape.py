"""Which sides of its rectangle an outline shows: I, L, U or V."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numba import njit

from datmo.arrays import F64, I64, U8

LEAST_SHARE = 0.1  # of the outline's points, for a side to be seen
LEAST_POINTS = 2
LEAST_ON_SIDES = 0.5  # below this share the outline does not follow the rectangle


class Shape(IntEnum):
    """What the outline looks like from above."""

    NONE = 0
    I = 1  # noqa: E741 - one side
    L = 2  # two sides that meet at a right angle
    U = 3  # three sides or more, or two opposite ones
    V = 4  # most points lie on no side: two lines askew, or a round thing


def shapes(outline: F64, length: I64, angle: F64, extent: F64, tolerance: float) -> U8:
    """`Shape` (k,) of each outline.

    Args:
        outline: (k, m, 2) [m], of which `length` (k,) rows count.
        angle: (k,) of the rectangle [rad].
        extent: (k, 4) x0, x1, y0, y1 of the rectangle along its axes [m].
        tolerance: a point this near to an edge lies on that side [m].
    """
    on = _on_sides(outline, length, np.cos(angle), np.sin(angle), extent, tolerance)
    seen = (on >= LEAST_POINTS) & (on >= LEAST_SHARE * length[:, None])
    across, along = seen[:, :2].sum(1), seen[:, 2:].sum(1)
    thin = np.minimum(extent[:, 1] - extent[:, 0], extent[:, 3] - extent[:, 2]) < 2 * tolerance
    askew = on.sum(1) < LEAST_ON_SIDES * length
    return np.select(
        [length < 2, thin, askew, across + along <= 1, (across == 1) & (along == 1)],
        [Shape.NONE, Shape.I, Shape.V, Shape.I, Shape.L],
        Shape.U,
    ).astype(np.uint8)


@njit(cache=True, nogil=True)
def _on_sides(outline: F64, length: I64, cos: F64, sin: F64, extent: F64, tolerance: float) -> I64:
    """Number (k, 4) of outline points that lie on each side, x0, x1, y0, y1; a point lies on the nearest."""
    on = np.zeros((len(length), 4), np.int64)
    for k in range(len(length)):
        for i in range(length[k]):
            x = cos[k] * outline[k, i, 0] + sin[k] * outline[k, i, 1]
            y = cos[k] * outline[k, i, 1] - sin[k] * outline[k, i, 0]
            side, nearest = 0, np.inf
            for e in range(4):
                distance = abs((x if e < 2 else y) - extent[k, e])
                if distance < nearest:
                    side, nearest = e, distance
            if nearest <= tolerance:
                on[k, side] += 1
    return on
