"""Under-segmentation: a cluster that several predicted boxes share is cut between them."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32, I64, Array
from datmo.clusters.config import SplitConfig
from datmo.errors import MessageError
from datmo.messages import Boxes, Clusters


def split_clusters(
    points_world: Array,
    clusters: Clusters,
    predicted: Boxes,
    dt: F32 | None = None,
    config: SplitConfig | None = None,
) -> Clusters:
    """Cut the clusters that hold the returns of several tracked objects.

    A point belongs to the predicted box that it lies deepest in, or nearest to, no farther than `tolerance`;
    a box is where it was when the point was measured. A box claims a cluster when enough of its points
    belong to it, and most of them lie in no other box: so neither a track that repeats another, nor one of a
    part, cuts the whole. Of boxes that move alike only the first claims: they may be parts of one body seen
    between poles. Where several boxes claim a cluster, each of its points goes to the nearest.

    Args:
        points_world: (n, 3) [m, world]; rows of the clusters' labels.
        clusters: of this scan. config: settings.
        predicted: boxes of mature tracks, predicted to this scan's stamp [world].
        dt: (n,) when each point was measured, relative to that stamp [s]; at the stamp if None.

    Returns:
        Clusters, labelled in the order of the old ones, the parts of one in the order of the boxes.

    Raises:
        MessageError: points are not (n, 3), or not as many as labels.
    """
    config = config or SplitConfig()
    points, n = np.asarray(points_world), len(clusters.label)
    if points.shape != (n, 3):
        raise MessageError(
            f"split_clusters was given points {points.shape} and {n} labels; points must "
            "be (n, 3) with one row a label; give the points the clusters were made from"
        )
    if not config.enabled or len(predicted) < 2 or clusters.count == 0:
        return clusters
    when = np.zeros(n, np.float32) if dt is None else dt
    return _relabel(clusters, _parts(points, clusters.label, predicted, when, config))


def _parts(points: Array, label: I32, predicted: Boxes, when: F32, config: SplitConfig) -> I64:
    """The part (n,) of its cluster that each point belongs to."""
    steps = np.nan_to_num(predicted.velocity)  # what has no velocity stands
    where = (predicted.center, predicted.size, predicted.yaw, steps)
    owner = _owners(points, when, label, *where, config.tolerance)
    part = np.zeros(len(label), np.int64)
    for c, claimants in _contested(label, owner, len(predicted), config.points):
        boxes = _bodies(steps, claimants, config.apart)
        rows = np.flatnonzero(label == c)
        distance = np.asarray(_distances(points[rows], when[rows], *(a[boxes] for a in where)))
        part[rows] = cut(distance, config)
    return part


def cut(distance: F64, config: SplitConfig) -> I64:
    """The part (m,) of each point of one cluster, from the distances (m, k) to the boxes [m]."""
    within = distance <= config.tolerance
    own = within & (distance.argmin(1)[:, None] == np.arange(distance.shape[1]))
    number = own.sum(0)
    held = own.T.astype(np.int64) @ (distance <= 0)  # (k, k): of the row's own, those in the column's box
    np.fill_diagonal(held, 0)
    claims = (number >= config.points) & (held.max(1) < config.explained * np.maximum(number, 1))
    if claims.sum() < 2:
        return np.zeros(len(distance), np.int64)
    return np.asarray(distance[:, claims].argmin(1))


def _bodies(velocity: F64, boxes: I64, least: float) -> I64:
    """The boxes without those that move as one before them does, which may be of another part of one body."""
    kept: list[int] = []
    for b in boxes.tolist():
        moves = np.hypot(*velocity[b]) >= least
        if not moves or all(np.hypot(*(velocity[b] - velocity[a])) >= least for a in kept):
            kept.append(b)
    return np.array(kept, np.int64)


def _contested(label: I32, owner: I64, boxes: int, least: int) -> list[tuple[int, I64]]:
    """The clusters in which several boxes own `least` points or more, each with those boxes."""
    owned = (label >= 0) & (owner >= 0)
    pairs, number = np.unique(label[owned] * np.int64(boxes) + owner[owned], return_counts=True)
    cluster, box = np.divmod(pairs[number >= least], boxes)
    several = np.flatnonzero(np.bincount(cluster) >= 2)
    return [(int(c), box[cluster == c]) for c in several]


@njit(cache=True, nogil=True)
def _distance(x: float, y: float, c: float, s: float, length: float, width: float) -> float:
    """Of a place from a rectangle about the origin, heading (c, s); negative inside [m]."""
    dx, dy = abs(c * x + s * y) - length / 2, abs(c * y - s * x) - width / 2
    if max(dx, dy) <= 0:
        return max(dx, dy)
    return float(np.hypot(max(dx, 0.0), max(dy, 0.0)))


@njit(cache=True, nogil=True)
def _owners(
    points: F64, dt: F32, label: I32, center: F64, size: F64, yaw: F64, velocity: F64, tolerance: float
) -> I64:
    """The nearest box (n,) to each point that has a label, -1 where none is within the tolerance."""
    owner = np.full(len(label), -1, np.int64)
    cos, sin = np.cos(yaw), np.sin(yaw)
    reach = (np.hypot(size[:, 0], size[:, 1]) / 2 + tolerance) ** 2
    for i in range(len(label)):
        if label[i] < 0:
            continue
        nearest = tolerance
        for b in range(len(center)):
            x = points[i, 0] - center[b, 0] - velocity[b, 0] * dt[i]
            y = points[i, 1] - center[b, 1] - velocity[b, 1] * dt[i]
            if x * x + y * y <= reach[b]:
                d = _distance(x, y, cos[b], sin[b], size[b, 0], size[b, 1])
                if d < nearest:
                    nearest, owner[i] = d, b
    return owner


@njit(cache=True, nogil=True)
def _distances(points: F64, dt: F32, center: F64, size: F64, yaw: F64, velocity: F64) -> F64:
    """Distance (m, k) of points (m, 3) from the boxes' rectangles, negative inside [m]."""
    out = np.empty((len(points), len(center)))
    for b in range(len(center)):
        c, s = np.cos(yaw[b]), np.sin(yaw[b])
        for i in range(len(points)):
            x = points[i, 0] - center[b, 0] - velocity[b, 0] * dt[i]
            y = points[i, 1] - center[b, 1] - velocity[b, 1] * dt[i]
            out[i, b] = _distance(x, y, c, s, size[b, 0], size[b, 1])
    return out


def _relabel(clusters: Clusters, part: I64) -> Clusters:
    """Labels without gaps, by old label and part; an old label without points goes."""
    if not part.any():
        return clusters
    seen = clusters.label >= 0
    kept, rank = np.unique(clusters.label[seen] * np.int64(part.max() + 1) + part[seen], return_inverse=True)
    label = np.full(len(part), -1, np.int32)
    label[seen] = rank
    return Clusters(label=label, count=len(kept))
