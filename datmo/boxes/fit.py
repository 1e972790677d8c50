"""Clusters to upright boxes that stand on the ground."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, I64, Array
from datmo.boxes.complete import complete
from datmo.boxes.config import BoxConfig
from datmo.boxes.gather import first_bad, gather, heights
from datmo.boxes.hull import least_area_angles
from datmo.boxes.outline import outlines
from datmo.boxes.rectangle import extents, search
from datmo.boxes.rules import Rejection, apply_rules
from datmo.boxes.shape import shapes
from datmo.boxes.upright import to_axes, upright
from datmo.boxes.volume import heading_of, least_volume_boxes
from datmo.errors import MessageError
from datmo.messages import Clusters, Detections


def fit_boxes(
    points_world: Array,
    clusters: Clusters,
    ground_z: Array,
    sensor_xy: Array,
    config: BoxConfig | None = None,
) -> tuple[Detections, tuple[Rejection, ...]]:
    """The box of what each cluster is a part of (method.md sections 6 and 7).

    The heading comes from the rectangle search over the outline (or, by `criterion`, from all the points:
    the rectangle of least area, the box of least volume), the seen extent from all the points,
    the base from the mean ground under them, the top from the highest. The rule filter sees this
    seen part. What a road user hides of itself is then added (see `datmo.boxes.complete`), so that
    the yaw lies along its length; yaw is known modulo pi at best.

    Args:
        points_world: (n, 3) [m, world].
        clusters: labels of the points.
        ground_z: (n,) height of the ground under each point [m, world].
        sensor_xy: (2,) where the sensor is [m, world].
        config: settings.

    Returns:
        Boxes in the order of the labels, yaw in [-pi/2, pi/2), score in (0, 1) growing with the
        number of points, and the rejections, in the order of the labels too: together they name
        every label once.

    Raises:
        MessageError: the arrays do not have one row a point, or a labelled one is not finite.
    """
    config = config or BoxConfig()
    points, ground = np.asarray(points_world, float), np.asarray(ground_z, float)
    _check(points, clusters, ground)
    found, number, clearance = _fit(points, ground, clusters, np.asarray(sensor_xy, float), config)
    passed, rejections = apply_rules(found.visible().size, number, clearance, config.filter)
    return found.select(passed), rejections


def _fit(
    points: F64, ground: F64, clusters: Clusters, sensor_xy: F64, config: BoxConfig
) -> tuple[Detections, I64, F64]:
    """The box, the number of points and the clearance [m] of each cluster, whatever they are."""
    points, ground, starts = gather(points, ground, clusters.label, clusters.count)
    number, step = np.diff(starts), np.deg2rad(config.outline_step)
    outline, length = outlines(points, starts, sensor_xy, config.outline_points, step)
    angle = _angles(points, starts, outline, length, config)
    extent = extents(points, starts, angle)
    base, top, clearance = heights(points[:, 2], ground, starts)
    height = np.maximum(top - base, 0)
    whole = complete(extent, height, to_axes(sensor_xy, angle), config.complete)
    boxes = upright(extent, whole, angle)
    center = np.column_stack([boxes.center, base + height / 2])
    found = Detections(
        center=center,
        size=np.column_stack([boxes.size, height]),
        yaw=boxes.yaw,
        score=(number / (number + config.half_points)).astype(np.float32),
        kind=whole.kind,
        cov=boxes.cov,
        seen=boxes.seen,
        shape=shapes(outline, length, angle, extent, config.side_tolerance),
        cluster=np.arange(clusters.count),
    )
    return found, number, clearance


def _angles(points: F64, starts: I64, outline: F64, length: I64, config: BoxConfig) -> F64:
    """Angle (k,) of each cluster's rectangle [rad, 0 <= angle < pi/2], from points (n, 3) [m, world]."""
    if config.criterion == "axis-aligned":
        return np.zeros(len(length))
    if config.criterion == "hull":
        return np.asarray(least_area_angles(np.ascontiguousarray(points[:, :2]), starts))
    if config.criterion == "volume":
        rotation, _, size = least_volume_boxes(points, starts)
        return heading_of(rotation, size)
    step = np.deg2rad(config.step)
    return search(outline, length, step, config.nearest, config.criterion, config.weights)


def _check(points: F64, clusters: Clusters, ground: F64) -> None:
    n = len(clusters.label)
    if points.shape != (n, 3) or ground.shape != (n,):
        raise MessageError(
            f"fit_boxes was given points {points.shape} and ground_z {ground.shape} for {n} labels; "
            "they must be (n, 3) and (n,); give one row a point"
        )
    row = first_bad(points, ground, clusters.label)
    if row >= 0:
        raise MessageError(
            f"fit_boxes: point {row} is {points[row]} on ground {ground[row]}; a point with a label must be "
            "finite; give it the label -1"
        )
