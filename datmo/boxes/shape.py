"""Which sides of its rectangle an outline shows: I, L, U or V."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

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
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x = c * outline[..., 0] + s * outline[..., 1]
    y = c * outline[..., 1] - s * outline[..., 0]
    distance = np.abs(np.stack([x, x, y, y], -1) - extent[:, None, :])  # (k, m, 4)
    counts = np.arange(outline.shape[1]) < length[:, None]
    near = counts & (distance.min(-1, initial=np.inf) <= tolerance)
    side = distance.argmin(-1)
    on = np.stack([(near & (side == e)).sum(1) for e in range(4)], 1)  # (k, 4)
    seen = (on >= LEAST_POINTS) & (on >= LEAST_SHARE * length[:, None])
    across, along = seen[:, :2].sum(1), seen[:, 2:].sum(1)
    thin = np.minimum(extent[:, 1] - extent[:, 0], extent[:, 3] - extent[:, 2]) < 2 * tolerance
    askew = on.sum(1) < LEAST_ON_SIDES * length
    return np.select(
        [length < 2, thin, askew, across + along <= 1, (across == 1) & (along == 1)],
        [Shape.NONE, Shape.I, Shape.V, Shape.I, Shape.L],
        Shape.U,
    ).astype(np.uint8)
