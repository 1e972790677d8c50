"""Volume that upright boxes share, over that of both: what real tracks are matched by."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, Bool
from datmo.geometry import corners_bev
from datmo.messages import Boxes

TOUCH = 1e-9  # a corner this near to an edge lies on it [m]


def iou_3d(a: Boxes, b: Boxes) -> F64:
    """Intersection over union (n, m) of the volumes of two sets of boxes, 0..1, each at its yaw."""
    reach = np.hypot(*a.size[:, :2].T)[:, None] + np.hypot(*b.size[:, :2].T)
    gap = np.linalg.norm(a.center[:, None, :2] - b.center[None, :, :2], axis=2)
    i, j = np.nonzero(gap < reach / 2)
    area = shared_area(
        corners_bev(a.center[i], a.size[i], a.yaw[i]), corners_bev(b.center[j], b.size[j], b.yaw[j])
    )
    top = np.minimum(a.center[i, 2] + a.size[i, 2] / 2, b.center[j, 2] + b.size[j, 2] / 2)
    bottom = np.maximum(a.center[i, 2] - a.size[i, 2] / 2, b.center[j, 2] - b.size[j, 2] / 2)
    shared = area * np.maximum(top - bottom, 0)
    union = a.size[i].prod(axis=1) + b.size[j].prod(axis=1) - shared
    out = np.zeros((len(a), len(b)))
    out[i, j] = np.clip(shared / np.maximum(union, 1e-12), 0, 1)
    return out


def shared_area(a: F64, b: F64) -> F64:
    """Area (p,) [m²] that the convex quadrilaterals a and b (p, 4, 2) share, both counter-clockwise.

    The corners of what they share are the corners of one inside the other and the crossings of
    their edges; in order of angle about their middle they go around it.
    """
    crossing, crosses = _crossings(a, b)
    points = np.concatenate([a, b, crossing], axis=1)
    valid = np.concatenate([_inside(a, b), _inside(b, a), crosses], axis=1)
    middle = np.where(valid[..., None], points, 0).sum(1) / np.maximum(valid.sum(1), 1)[:, None]
    any_valid = points[np.arange(len(points)), np.argmax(valid, axis=1)]
    arms = np.where(valid[..., None], points, any_valid[:, None]) - middle[:, None]
    order = np.argsort(np.arctan2(arms[..., 1], arms[..., 0]), axis=1)
    arms = np.take_along_axis(arms, order[..., None], axis=1)
    area = 0.5 * _cross(arms, np.roll(arms, -1, axis=1)).sum(axis=1)
    return np.where(valid.any(axis=1), np.maximum(area, 0), 0.0)


def _inside(points: F64, polygon: F64) -> Bool:
    """(p, 4) whether points (p, 4, 2) lie in polygons (p, 4, 2) or on their edges."""
    edge = np.roll(polygon, -1, axis=1) - polygon
    side = _cross(edge[:, None], points[:, :, None] - polygon[:, None])
    return np.asarray((side >= -TOUCH * np.linalg.norm(edge, axis=2)[:, None]).all(axis=2))


def _crossings(a: F64, b: F64) -> tuple[F64, Bool]:
    """Where the edges of a and b (p, 4, 2) cross (p, 16, 2), and whether they do; parallels do not."""
    along_a, along_b = np.roll(a, -1, axis=1) - a, np.roll(b, -1, axis=1) - b
    gap = b[:, None] - a[:, :, None]
    turn = _cross(along_a[:, :, None], along_b[:, None])
    apart = np.abs(turn) > 1e-12
    safe = np.where(apart, turn, 1.0)
    s, t = _cross(gap, along_b[:, None]) / safe, _cross(gap, along_a[:, :, None]) / safe
    crosses = apart & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    at = a[:, :, None] + s[..., None] * along_a[:, :, None]
    return at.reshape(-1, 16, 2), crosses.reshape(-1, 16)


def _cross(a: F64, b: F64) -> F64:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
