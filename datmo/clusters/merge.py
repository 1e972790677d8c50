"""Over-segmentation: clusters under one predicted box become one again (Alg. 9, corrected)."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F64, I32, Array
from datmo.clusters.config import MergeConfig
from datmo.errors import MessageError
from datmo.messages import Boxes, Clusters


def merge_clusters(
    points_world: Array, clusters: Clusters, predicted: Boxes, config: MergeConfig | None = None
) -> Clusters:
    """Merge the clusters that one predicted box says are parts of one object (method.md section 8).

    The footprint of a cluster is its extent along the predicted box's own axes. A cluster is a
    candidate of a box when they share more than `share` of the smaller of the two areas; where
    several boxes claim it, the one that shares most keeps it, so clusters that two tracks claim
    never merge. Candidates join, the one with the largest overlap first, as long as the merged
    footprint does not exceed the predicted box (area factor and dimensions within tolerance).

    Args:
        points_world: (n, 3) [m, world]; rows of the clusters' labels.
        clusters: of this scan.
        predicted: boxes of mature tracks, predicted to this scan's stamp [world].
        config: settings.

    Returns:
        Clusters in which a merged one has the lowest label of its parts, renumbered without gaps.

    Raises:
        MessageError: points and labels differ in number.
    """
    config = config or MergeConfig()
    if len(points_world) != len(clusters.label):
        raise MessageError(
            f"merge_clusters was given {len(points_world)} points and {len(clusters.label)} labels; "
            "both must have one row a point; give the points the clusters were made from"
        )
    if len(predicted) == 0 or clusters.count < 2:
        return clusters
    extent = footprints(points_world, clusters, predicted, config.pad)
    half = np.stack(
        [-predicted.size[:, 0], predicted.size[:, 0], -predicted.size[:, 1], predicted.size[:, 1]]
    )
    half = half.T[:, None, :] / 2
    overlap = _area(_intersection(extent, half))
    smaller = np.minimum(_area(extent), _area(half))
    share = overlap / np.maximum(smaller, 1e-9)
    owner = np.argmax(share, axis=0)
    target = np.arange(clusters.count)
    for box in range(len(predicted)):
        members = np.flatnonzero((owner == box) & (share[box] > config.share))
        members = members[np.argsort(-overlap[box, members], kind="stable")]
        joined = _join(extent[box], members, predicted.size[box], config)
        target[joined] = min(joined, default=0)
    return _relabel(clusters, target)


def footprints(points_world: Array, clusters: Clusters, boxes: Boxes, pad: float) -> F64:
    """Extent (k, c, 4) of each cluster along each box's axes about its centre: x0, x1, y0, y1 [m].

    No extent is less than `pad`. Clusters without a point have an extent at infinity.
    """
    raw = np.asarray(
        _extents(np.asarray(points_world), clusters.label, clusters.count, boxes.center[:, :2], boxes.yaw)
    )
    for low, high in ((0, 1), (2, 3)):
        short = np.maximum(pad - (raw[..., high] - raw[..., low]), 0) / 2
        raw[..., low] -= short
        raw[..., high] += short
    return raw


@njit(cache=True, nogil=True)
def _extents(points: Array, label: I32, count: int, centers: F64, yaws: F64) -> F64:
    extent = np.empty((len(centers), count, 4))
    for b in range(len(centers)):
        c, s = np.cos(yaws[b]), np.sin(yaws[b])
        extent[b, :, 0::2] = np.inf
        extent[b, :, 1::2] = -np.inf
        for i in range(len(points)):
            k = label[i]
            if k < 0:
                continue
            dx, dy = points[i, 0] - centers[b, 0], points[i, 1] - centers[b, 1]
            x, y = c * dx + s * dy, c * dy - s * dx
            extent[b, k, 0] = min(extent[b, k, 0], x)
            extent[b, k, 1] = max(extent[b, k, 1], x)
            extent[b, k, 2] = min(extent[b, k, 2], y)
            extent[b, k, 3] = max(extent[b, k, 3], y)
        for k in range(count):
            if extent[b, k, 0] > extent[b, k, 1]:
                extent[b, k] = 1e9
    return extent


def _join(extent: F64, members: Array, size: F64, config: MergeConfig) -> list[int]:
    """The members that together stay within the predicted box, largest overlap first."""
    joined: list[int] = []
    merged = np.array([np.inf, -np.inf, np.inf, -np.inf])
    for k in members:
        grown = np.where([True, False] * 2, np.minimum(merged, extent[k]), np.maximum(merged, extent[k]))
        sides = grown[1::2] - grown[0::2]
        fits = bool((sides <= size[:2] + config.tolerance).all())
        if fits and sides[0] * sides[1] <= config.area_factor * size[0] * size[1]:
            merged = grown
            joined.append(int(k))
    return joined


def _intersection(a: F64, b: F64) -> F64:
    low, high = np.maximum(a[..., 0::2], b[..., 0::2]), np.minimum(a[..., 1::2], b[..., 1::2])
    return np.stack([low[..., 0], high[..., 0], low[..., 1], high[..., 1]], -1)


def _area(extent: F64) -> F64:
    return np.asarray(np.prod(np.maximum(extent[..., 1::2] - extent[..., 0::2], 0), axis=-1))


def _relabel(clusters: Clusters, target: Array) -> Clusters:
    kept, rank = np.unique(target, return_inverse=True)
    label = np.append(rank, -1).astype(np.int32)[clusters.label]
    return Clusters(label=label, count=len(kept))
