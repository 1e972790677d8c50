"""Who may be matched with whom: gates, bird's-eye distances and the optimal assignment."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

from datmo.arrays import F64, I64, U8, Array, Bool
from datmo.messages import VEHICLES, Boxes, Frame, Truth, is_any

VEHICLE_GATE, OTHER_GATE = 2.0, 1.0
VEHICLE_REACH, OTHER_REACH = 4.0, 2.0
BOX_MARGIN = 0.2
STRIP = 0.5


def gates(truth: Boxes) -> F64:
    """Gate (k,) [m] of each true object: max(2, half its length) for vehicles, 1 for others."""
    wide = np.maximum(VEHICLE_GATE, truth.size[:, 0] / 2)
    return np.where(is_any(truth.kind, VEHICLES), wide, OTHER_GATE)


def reaches(kind: U8) -> F64:
    """d0 (k,) [m], the distance at which similarity ends: 4 for vehicles, 2 for others."""
    return np.where(is_any(kind, VEHICLES), VEHICLE_REACH, OTHER_REACH)


def distances(a: F64, b: F64) -> F64:
    """Bird's-eye distances (k, m) [m] between places (k, >= 2) and (m, >= 2)."""
    difference = a[:, None, :2] - b[None, :, :2]
    return np.hypot(difference[..., 0], difference[..., 1])


def assign(cost: F64, allowed: Bool) -> tuple[I64, I64]:
    """The one-to-one pairs that are most in number, then least in total cost (Hungarian).

    Args:
        cost: (k, m), read only where allowed. allowed: (k, m).

    Returns:
        rows and columns of the pairs, by rising row.
    """
    if not allowed.any():
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    # One forbidden pair must cost more than all the allowed ones can save.
    forbidden = 1 + 2 * min(cost.shape) * (1 + float(np.abs(cost[allowed]).max()))
    row, column = linear_sum_assignment(np.where(allowed, cost, forbidden))
    kept = allowed[row, column]
    return row[kept].astype(np.int64), column[kept].astype(np.int64)


def finite(points: Array) -> Bool:
    """(n,) whether all three coordinates are finite."""
    return np.asarray(np.isfinite(points[:, 0] + points[:, 1] + points[:, 2]))


class Returns:
    """The returns that perception holds for obstacles, by place, to ask what a box is made of."""

    def __init__(self, frame: Frame, truth: Truth) -> None:
        points, T = frame.scan.points, frame.scan.T_world_sensor
        rows = np.flatnonzero(~frame.ground.is_ground & finite(points))
        held = points[rows].astype(float)
        x, y = (T[i, 0] * held[:, 0] + T[i, 1] * held[:, 1] + T[i, 2] * held[:, 2] + T[i, 3] for i in (0, 1))
        # Strips of 0.5 m along x as 16-bit numbers, which numpy sorts by radix; far ones wrap
        # around and are told apart by place.
        strip = np.floor(x / STRIP).astype(np.int64).astype(np.int16)
        order = np.argsort(strip, kind="stable")
        self._strip = strip[order]
        self._x, self._y = x[order], y[order]
        self._is_thing: Bool = (truth.thing[rows] >= 0)[order]

    def on_things(self, boxes: Boxes) -> tuple[Bool, Bool]:
        """Whether most obstacle returns inside each box come from things, and whether it has any.

        Args:
            boxes: k boxes [world].

        Returns:
            on_thing (k,), holds_returns (k,).
        """
        on_thing, holds = np.zeros(len(boxes), bool), np.zeros(len(boxes), bool)
        half = boxes.size[:, :2] / 2 + BOX_MARGIN
        radius = np.hypot(half[:, 0], half[:, 1])
        ends = np.floor((boxes.center[:, :1] + radius[:, None] * [-1, 1]) / STRIP).astype(np.int64)
        first = np.searchsorted(self._strip, ends[:, 0].astype(np.int16), side="left")
        last = np.searchsorted(self._strip, ends[:, 1].astype(np.int16), side="right")
        for i, (low, high) in enumerate(zip(first.tolist(), last.tolist(), strict=True)):
            x, y = self._x[low:high] - boxes.center[i, 0], self._y[low:high] - boxes.center[i, 1]
            near = np.flatnonzero(np.abs(y) <= radius[i])
            x, y = x[near], y[near]
            c, s = np.cos(boxes.yaw[i]), np.sin(boxes.yaw[i])
            inside = (np.abs(c * x + s * y) <= half[i, 0]) & (np.abs(c * y - s * x) <= half[i, 1])
            made_of = self._is_thing[low:high][near[inside]]
            holds[i] = len(made_of) > 0
            on_thing[i] = holds[i] and bool(2 * np.count_nonzero(made_of) > len(made_of))
        return on_thing, holds
