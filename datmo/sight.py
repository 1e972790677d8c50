"""Sight from a scan: how far its rays saw, by azimuth and elevation."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, Bool
from datmo.messages import Scan, Sight
from datmo.messages.sight import AZIMUTH_STEP, ELEVATION_STEP, HIGHEST, LOWEST

ROWS = round((HIGHEST - LOWEST) / ELEVATION_STEP)
COLUMNS = round(2 * np.pi / AZIMUTH_STEP)
EDGES = np.tan(LOWEST + ELEVATION_STEP * np.arange(ROWS + 1))
BLIND = 0.5  # [m] nearer returns are of the sensor itself


def make_sight(scan: Scan, keep: Bool | None = None) -> Sight:
    """Nearest and farthest return of `scan` in each direction.

    Args:
        scan: one sweep.
        keep: (n,) points to use, as `refine` gives them; None takes all. Points that are not
            finite are left out in any case.
    """
    keep = np.ones(len(scan), np.bool_) if keep is None else keep
    near, far, late, number = _extremes(scan.points, scan.dt, keep, EDGES)
    return Sight(near=near, far=far, T_world_sensor=scan.T_world_sensor, dt=_fill(late, number))


def _fill(late: F64, number: F64) -> F32:
    """Mean time of each column's returns; columns without any take that of the nearest one with some."""
    known = np.flatnonzero(number)
    if len(known) == 0:
        return np.zeros(len(number), np.float32)
    here = np.arange(len(number))
    right = np.minimum(np.searchsorted(known, here), len(known) - 1)
    left = np.maximum(right - 1, 0)
    nearest = np.where(np.abs(known[left] - here) < np.abs(known[right] - here), known[left], known[right])
    return np.asarray(late[nearest] / number[nearest], np.float32)


@njit(cache=True, nogil=True)
def _extremes(
    points: F32, dt: F32, keep: Bool, edges: F64
) -> tuple[F32, F32, F64, F64]:  # pragma: no cover - compiled
    """Nearest and farthest range (rows, columns), 0 where nothing returned; times, numbers by column.

    Rows are found by the tangent of the elevation, which spares an arctangent.
    """
    rows = len(edges) - 1
    near = np.zeros((rows, COLUMNS), np.float32)
    far = np.zeros((rows, COLUMNS), np.float32)
    late, number = np.zeros(COLUMNS), np.zeros(COLUMNS)
    scale = COLUMNS / (2 * np.pi)
    for i in range(len(points)):
        x, y, z = float(points[i, 0]), float(points[i, 1]), float(points[i, 2])
        flat = np.sqrt(x * x + y * y)
        distance = np.sqrt(flat * flat + z * z)
        if not keep[i] or not distance >= BLIND or not np.isfinite(distance) or flat == 0:
            continue
        tangent = z / flat
        if tangent < edges[0] or tangent >= edges[rows]:
            continue
        # the tangent is nearly linear here: guess, then step to the right row
        row = min(int((tangent - edges[0]) / (edges[rows] - edges[0]) * rows), rows - 1)
        while tangent < edges[row]:
            row -= 1
        while tangent >= edges[row + 1]:
            row += 1
        column = int((np.arctan2(y, x) + np.pi) * scale) % COLUMNS
        late[column] += dt[i]
        number[column] += 1.0
        if far[row, column] == 0:
            near[row, column] = far[row, column] = distance
        else:
            near[row, column] = min(near[row, column], distance)
            far[row, column] = max(far[row, column], distance)
    return near, far, late, number
