"""Volume that upright boxes share, over that of both: what real tracks are matched by."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from datmo.geometry import corners_bev, overlap_bev
from datmo.messages import Boxes


def iou_3d(a: Boxes, b: Boxes) -> F64:
    """Intersection over union (n, m) of the volumes of two sets of boxes, 0..1, each at its yaw."""
    reach = np.hypot(*a.size[:, :2].T)[:, None] + np.hypot(*b.size[:, :2].T)
    gap = np.linalg.norm(a.center[:, None, :2] - b.center[None, :, :2], axis=2)
    i, j = np.nonzero(gap < reach / 2)
    outline_a, outline_b = (corners_bev(x.center, x.size, x.yaw) for x in (a, b))
    area = np.array([overlap_bev(outline_a[k], outline_b[m]) for k, m in zip(i, j, strict=True)])
    top = np.minimum(a.center[i, 2] + a.size[i, 2] / 2, b.center[j, 2] + b.size[j, 2] / 2)
    bottom = np.maximum(a.center[i, 2] - a.size[i, 2] / 2, b.center[j, 2] - b.size[j, 2] / 2)
    shared = area * np.maximum(top - bottom, 0)
    union = a.size[i].prod(axis=1) + b.size[j].prod(axis=1) - shared
    out = np.zeros((len(a), len(b)))
    out[i, j] = np.clip(shared / np.maximum(union, 1e-12), 0, 1)
    return out
