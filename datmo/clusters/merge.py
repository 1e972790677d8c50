"""Over-segmentation: clusters under one predicted box become one again (Alg. 9, corrected)."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F64, I32, Array
from datmo.clusters.config import MergeConfig
from datmo.errors import MessageError
from datmo.messages import Boxes, Clusters

FAR = 1e9  # [m]


def merge_clusters(
    points_world: Array, clusters: Clusters, predicted: Boxes, config: MergeConfig | None = None
) -> Clusters:
    """Merge the clusters that one predicted box says are parts of one object (method.md section 8).

    The footprint of a cluster is its extent along the predicted box's own axes. A cluster is a
    candidate of a box when they share more than `share` of the smaller of the two areas; where
    several boxes claim it, the one that shares most keeps it, of those that hold it whole the one
    whose middle it is nearest to by that box's own measure, so clusters that two tracks claim never
    merge. Candidates join, the one with the largest overlap first, as long as the merged
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
    if not config.enabled or len(predicted) == 0 or clusters.count < 2:
        return clusters
    return _relabel(
        clusters, _targets(footprints(points_world, clusters, predicted, config.pad), predicted, config)
    )


def _targets(extent: F64, predicted: Boxes, config: MergeConfig) -> Array:
    """The label (c,) that each cluster takes, from the footprints (k, c, 4) along the k boxes."""
    half = predicted.size[:, [0, 0, 1, 1]] / 2 * np.array([-1, 1, -1, 1])
    overlap = _area(_intersection(extent, half[:, None]))
    share = overlap / np.maximum(np.minimum(_area(extent), _area(half)[:, None]), 1e-9)
    middle = np.abs(extent[..., 0::2] + extent[..., 1::2]) / 2
    offset = (middle / np.maximum(half[:, None, 1::2], 1e-9)).max(-1)  # 1 at the box's edge
    most = share >= share.max(axis=0) - 1e-9
    owner = np.argmin(np.where(most, offset, np.inf), axis=0)
    target = np.arange(extent.shape[1])
    for box in range(len(predicted)):
        members = np.flatnonzero((owner == box) & (share[box] > config.share))
        members = members[np.argsort(-overlap[box, members], kind="stable")]
        joined = _join(extent[box], members, predicted.size[box], config)
        target[joined] = min(joined, default=0)
    return target


def footprints(points_world: Array, clusters: Clusters, boxes: Boxes, pad: float) -> F64:
    """Extent (k, c, 4) of each cluster along each box's axes about its centre: x0, x1, y0, y1 [m].

    No extent is less than `pad`. A cluster that cannot touch the box, or has no point, lies far away.
    """
    reach = np.hypot(boxes.size[:, 0], boxes.size[:, 1]) / 2 + pad
    raw = np.asarray(
        _extents(np.asarray(points_world), clusters.label, clusters.count, boxes.center, boxes.yaw, reach)
    )
    for low, high in ((0, 1), (2, 3)):
        short = np.maximum(pad - (raw[..., high] - raw[..., low]), 0) / 2
        raw[..., low] -= short
        raw[..., high] += short
    return raw


@njit(cache=True, nogil=True)
def _extents(points: Array, label: I32, count: int, centers: F64, yaws: F64, reach: F64) -> F64:
    about = np.empty((count, 4))  # along the world's axes
    about[:, 0::2] = np.inf
    about[:, 1::2] = -np.inf
    for i in range(len(points)):
        if label[i] >= 0:
            _widen(about[label[i]], points[i, 0], points[i, 1])
    extent = np.empty((len(centers), count, 4))
    near = np.empty(count, np.bool_)
    for b in range(len(centers)):
        x, y, c, s = centers[b, 0], centers[b, 1], np.cos(yaws[b]), np.sin(yaws[b])
        for k in range(count):
            dx, dy = max(about[k, 0] - x, x - about[k, 1]), max(about[k, 2] - y, y - about[k, 3])
            near[k] = max(dx, dy) <= reach[b]
            extent[b, k, 0::2] = np.inf if near[k] else FAR
            extent[b, k, 1::2] = -np.inf if near[k] else FAR
        for i in range(len(points)):
            if label[i] >= 0 and near[label[i]]:
                dx, dy = points[i, 0] - x, points[i, 1] - y
                _widen(extent[b, label[i]], c * dx + s * dy, c * dy - s * dx)
    return extent


@njit(cache=True, nogil=True)
def _widen(extent: F64, x: float, y: float) -> None:
    extent[0], extent[1] = min(extent[0], x), max(extent[1], x)
    extent[2], extent[3] = min(extent[2], y), max(extent[3], y)


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
