"""The map of ground-height error: a grid over the world that grows by whole frames, not by clouds."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from datmo.geometry import transform
from datmo.messages import Frame, Truth

CELL, RADIUS = 1.0, 50.0
HALF = 250


class HeightMap:
    """Mean error of the ground's height, predicted minus true, in cells of the world.

    Only returns within 50 m of the sensor count, as in the metrics; the map reaches 250 m from
    where it began, and what lies farther is left out.
    """

    def __init__(self) -> None:
        self._origin: F64 | None = None
        self._sum = np.zeros((2 * HALF, 2 * HALF))
        self._count = np.zeros((2 * HALF, 2 * HALF))

    def add(self, frame: Frame, truth: Truth) -> None:
        """Take in one frame: the error at each of its returns, on the ground and above it."""
        points = frame.scan.points
        error = frame.ground.height.astype(float) - truth.height
        near = np.hypot(points[:, 0], points[:, 1]) < RADIUS
        known = near & np.isfinite(error) & np.isfinite(points).all(1)
        xy = transform(frame.scan.T_world_sensor, points[known])[:, :2]
        if self._origin is None:
            self._origin = frame.scan.T_world_sensor[:2, 3].copy()
        cell = np.floor((xy - self._origin) / CELL).astype(np.int64) + HALF
        inside = ((cell >= 0) & (cell < 2 * HALF)).all(1)
        flat = cell[inside, 1] * 2 * HALF + cell[inside, 0]
        size = self._sum.size
        self._sum += np.bincount(flat, error[known][inside], size).reshape(self._sum.shape)
        self._count += np.bincount(flat, minlength=size).reshape(self._sum.shape)

    def mean(self) -> tuple[F64, tuple[float, float, float, float]]:
        """Error (rows, columns) [m], NaN where nothing returned, and x_min, x_max, y_min, y_max [m, world].

        Cut to what was seen.
        """
        rows, columns = np.nonzero(self._count)
        if len(rows) == 0 or self._origin is None:
            return np.full((1, 1), np.nan), (0.0, 1.0, 0.0, 1.0)
        r0, r1, c0, c1 = rows.min(), rows.max() + 1, columns.min(), columns.max() + 1
        count = self._count[r0:r1, c0:c1]
        mean = np.where(count > 0, self._sum[r0:r1, c0:c1] / np.maximum(count, 1), np.nan)
        x, y = self._origin
        west, south = x - HALF * CELL, y - HALF * CELL
        extent = (west + c0 * CELL, west + c1 * CELL, south + r0 * CELL, south + r1 * CELL)
        return mean, (float(extent[0]), float(extent[1]), float(extent[2]), float(extent[3]))
