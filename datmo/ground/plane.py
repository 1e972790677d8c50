"""The local slope: a plane through the ground about the sensor, blind to what stands on it."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64

STEEPEST = 0.6
BELOW = 0.3
QUANTILE_SCALES, ROBUST_SCALES = np.geomspace(1.0, 0.05, 7), np.geomspace(0.4, 0.1, 4)
RIDGE = 1e-3


@numba.njit(cache=True, nogil=True)
def _solve(xyz: F64, w: F64) -> F64:
    """Weighted least-squares plane (3,), its slopes held by a weak ridge and to `STEEPEST`."""
    xx, yy, n, xy, sx, sy, xz, yz, sz = RIDGE, RIDGE, 1e-9, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(xyz)):
        x, y, z = xyz[i, 0], xyz[i, 1], xyz[i, 2]
        wx, wy, wz = w[i] * x, w[i] * y, w[i] * z
        xx, xy, sx, xz = xx + wx * x, xy + wx * y, sx + wx, xz + wx * z
        yy, sy, yz = yy + wy * y, sy + wy, yz + wy * z
        n, sz = n + w[i], sz + wz
    A, b = np.array([[xx, xy, sx], [xy, yy, sy], [sx, sy, n]]), np.array([xz, yz, sz])
    # By cofactors: no BLAS, so the bytes do not depend on its threads.
    inverse = np.empty((3, 3))
    for j in range(3):
        inverse[j] = np.cross(A[(j + 1) % 3], A[(j + 2) % 3])
    det = A[0, 0] * inverse[0, 0] + A[0, 1] * inverse[0, 1] + A[0, 2] * inverse[0, 2]
    plane = np.zeros(3)
    for j in range(3):
        for k in range(3):
            plane[k] += inverse[j, k] * b[j] / det
    plane[0] = min(max(plane[0], -STEEPEST), STEEPEST)
    plane[1] = min(max(plane[1], -STEEPEST), STEEPEST)
    return plane


@numba.njit(cache=True, nogil=True)
def _settle(xyz: F64, plane: F64, quantile_scales: F64, robust_scales: F64) -> F64:
    """Re-weighted least squares from `plane`: for a low quantile, then robustly."""
    w, n = np.empty(len(xyz)), len(xyz)
    for phase, scales in enumerate((quantile_scales, robust_scales)):
        for scale in scales:
            a, b, c = plane
            for i in range(n):
                e = xyz[i, 2] - a * xyz[i, 0] - b * xyz[i, 1] - c
                low = (BELOW if e > 0 else 1 - BELOW) / np.sqrt(e * e + scale * scale)
                u = e / scale if e > 0 else e / (2 * scale)
                w[i] = low if phase == 0 else 1 / ((1 + u * u) * (1 + u * u))
            plane = _solve(xyz, w)
    return plane


def robust_plane(xyz: F64, start_height: float) -> F64:
    """Plane (3,) z = a x + b y + c through the ground among lowest points.

    Re-weighted least squares: first for the quantile 0.3 (obstacles lie above, so more than half of
    the points may be theirs), then with a robust weight that is narrower above than below. Where
    there are fewer than three points: level, at their height, or at `start_height` without any.

    Args:
        xyz: (n, 3) [m, sensor].
    """
    plane = np.array([0.0, 0.0, start_height])
    if len(xyz):
        plane[2] = np.quantile(xyz[:, 2], BELOW)
    if len(xyz) < 3:
        return plane
    return np.asarray(_settle(xyz, plane, QUANTILE_SCALES, ROBUST_SCALES))
