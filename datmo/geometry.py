"""Transforms, angles and the overlap of boxes seen from above.

`T_a_b` takes coordinates in b to coordinates in a: p_a = T_a_b p_b, and T_a_c = T_a_b T_b_c.
"""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, Array

RIGID = 1e-3  # largest error of a rotation's products


def wrap_angle(angle: Array | float) -> F64:
    """The same angle in [-pi, pi) [rad]."""
    return np.asarray((np.asarray(angle, float) + np.pi) % (2 * np.pi) - np.pi)


def half_turn(angle: Array | float) -> F64:
    """The same direction, heads and tails alike, in [-pi/2, pi/2) [rad]."""
    return np.asarray((np.asarray(angle, float) + np.pi / 2) % np.pi - np.pi / 2)


def axes_of(yaw: F64) -> F64:
    """(k, 2, 2) unit vectors along and across each heading (k,) [rad], row by row."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.stack([c, s, -s, c], 1).reshape(-1, 2, 2)


def transform(T_a_b: F64, points_b: Array) -> F64:
    """Points (n, 3) in b expressed in a, (n, 3) float64."""
    x, y, z = np.asarray(points_b, float).T
    points_a = np.empty((len(x), 3))
    for i in range(3):  # elementwise: the bytes of a BLAS product may depend on its threads
        points_a[:, i] = T_a_b[i, 0] * x + T_a_b[i, 1] * y + T_a_b[i, 2] * z + T_a_b[i, 3]
    return points_a


def inverse(T_a_b: F64) -> F64:
    """T_b_a of a rigid transform (..., 4, 4)."""
    R = np.swapaxes(T_a_b[..., :3, :3], -1, -2)
    T_b_a = np.zeros_like(T_a_b)
    T_b_a[..., :3, :3] = R
    T_b_a[..., :3, 3] = -np.matmul(R, T_a_b[..., :3, 3, None])[..., 0]
    T_b_a[..., 3, 3] = 1
    return T_b_a


def is_rigid(T_a_b: F64) -> bool:
    """Whether a matrix (4, 4) is a rotation and a translation, up to the rounding of printed poses."""
    R = T_a_b[:3, :3]
    error = np.abs(np.einsum("ij,kj->ik", R, R) - np.eye(3)).max()
    return bool(error < RIGID and np.linalg.det(R) > 0 and np.abs(T_a_b[3] - [0, 0, 0, 1]).max() < RIGID)


def rotation_z(yaw: Array | float) -> F64:
    """Rotation matrices (..., 3, 3) about z by `yaw` [rad]."""
    c, s = np.cos(np.asarray(yaw, float)), np.sin(np.asarray(yaw, float))
    R = np.zeros((*c.shape, 3, 3))
    R[..., 0, 0], R[..., 0, 1], R[..., 1, 0], R[..., 1, 1], R[..., 2, 2] = c, -s, s, c, 1
    return R


def corners_bev(center: F64, size: F64, yaw: F64) -> F64:
    """Corners (k, 4, 2) of boxes from above, counter-clockwise from front left.

    Args:
        center: (k, >=2) [m]. size: (k, >=2) length, width [m]. yaw: (k,) [rad].
    """
    signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]], float)
    half = signs * np.asarray(size, float)[:, None, :2] / 2
    c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    x = c * half[..., 0] - s * half[..., 1]
    y = s * half[..., 0] + c * half[..., 1]
    return np.asarray(np.stack([x, y], -1) + np.asarray(center, float)[:, None, :2])


def polygon_area(polygon: F64) -> float:
    """Signed area [m²] of a polygon (m, 2), positive when counter-clockwise."""
    x, y = polygon[:, 0], polygon[:, 1]
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def clip_convex(subject: F64, clip: F64) -> F64:
    """Intersection (m, 2) of two convex counter-clockwise polygons (Sutherland-Hodgman)."""
    output = subject
    for a, b in zip(clip, np.roll(clip, -1, axis=0), strict=True):
        if len(output) == 0:
            return output
        edge = b - a
        side = edge[0] * (output[:, 1] - a[1]) - edge[1] * (output[:, 0] - a[0])
        kept: list[F64] = []
        for i in range(len(output)):
            j = (i + 1) % len(output)
            if side[i] >= 0:
                kept.append(output[i])
            if side[i] * side[j] < 0:
                kept.append(output[i] + side[i] / (side[i] - side[j]) * (output[j] - output[i]))
        output = np.array(kept).reshape(-1, 2)
    return output


def overlap_bev(a: F64, b: F64) -> float:
    """Area [m²] shared by two convex counter-clockwise polygons (m, 2)."""
    shared = clip_convex(a, b)
    return abs(polygon_area(shared)) if len(shared) >= 3 else 0.0


def iou_bev(a: F64, b: F64) -> float:
    """Intersection over union of two convex counter-clockwise polygons (m, 2), 0..1."""
    shared = overlap_bev(a, b)
    union = polygon_area(a) + polygon_area(b) - shared
    return shared / union if union > 0 else 0.0
