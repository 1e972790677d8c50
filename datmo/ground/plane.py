"""The local slope: a plane through the ground about the sensor, blind to what stands on it."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64

STEEPEST = 0.6
BELOW = 0.3
RIDGE = 1e-3


@numba.njit(cache=True, nogil=True)
def _solve(xyz: F64, w: F64) -> F64:
    """Weighted least-squares plane (3,), its slopes held by a weak ridge and to `STEEPEST`."""
    A, b = np.zeros((3, 3)), np.zeros(3)
    A[0, 0] = A[1, 1] = RIDGE
    A[2, 2] = 1e-9
    row = np.ones(3)
    for i in range(len(xyz)):
        row[0], row[1] = xyz[i, 0], xyz[i, 1]
        for j in range(3):
            b[j] += w[i] * row[j] * xyz[i, 2]
            for k in range(3):
                A[j, k] += w[i] * row[j] * row[k]
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
    w = np.empty(len(xyz))
    for phase, scales in enumerate((quantile_scales, robust_scales)):
        for scale in scales:
            for i in range(len(xyz)):
                e = xyz[i, 2] - plane[0] * xyz[i, 0] - plane[1] * xyz[i, 1] - plane[2]
                if phase == 0:
                    w[i] = (BELOW if e > 0 else 1 - BELOW) / np.hypot(e, scale)
                else:
                    u = e / scale if e > 0 else e / (2 * scale)
                    w[i] = 1 / (1 + u * u) ** 2
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
    return np.asarray(_settle(xyz, plane, np.geomspace(1.0, 0.05, 7), np.geomspace(0.4, 0.1, 4)))
