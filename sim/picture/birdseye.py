"""The bird's-eye picture of a scan and its truth: cloud by class, true boxes, the ego."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, U8, Array, Bool
from datmo.geometry import corners_bev, inverse, transform
from datmo.messages import Boxes, Scan, Truth, Visibility
from sim.picture import palette
from sim.picture.raster import Raster

RADIUS, PIXELS = 50.0, 800
SENSOR_HEIGHT = 1.73
EGO_SHAPE = np.array(
    [[2.3, 0.7], [2.6, 0.0], [2.3, -0.7], [1.9, -0.95], [-2.2, -0.95], [-2.2, 0.95], [1.9, 0.95]]
)


def picture(scan: Scan, truth: Truth, radius: float = RADIUS, pixels: int = PIXELS) -> U8:
    """The picture (pixels, pixels, 3) around the sensor, forward up.

    Ground is grey-brown, lighter where higher; the rest has the colour of its kind. True boxes are
    white, dashed grey where hidden.

    Args:
        scan: what the sensor measured. truth: of the same scan.
        radius: half the extent [m]. pixels: side of the picture.
    """
    raster = Raster(pixels, radius)
    draw_rings(raster)
    none = np.zeros(len(scan), np.uint8)
    draw_cloud(raster, scan, truth.is_ground, none, truth)
    draw_truth(raster, Flat(scan), truth)
    draw_ego(raster)
    return raster.image


class Flat:
    """World places seen in the picture's own plane, the sensor's x-y."""

    def __init__(self, scan: Scan) -> None:
        self._T_sensor_world = inverse(scan.T_world_sensor)
        self._z = float(scan.T_world_sensor[2, 3]) - SENSOR_HEIGHT

    def __call__(self, xy: Array) -> F64:
        """(n, 2) [m, sensor] of places (n, 2) [m, world] at about the ego's ground."""
        xy = np.asarray(xy, float)
        return transform(self._T_sensor_world, np.c_[xy, np.full(len(xy), self._z)])[:, :2]

    def outlines(self, boxes: Boxes) -> F64:
        """Corners (k, 4, 2) of boxes from above."""
        corners = corners_bev(boxes.center, boxes.size, boxes.yaw)
        return self(corners.reshape(-1, 2)).reshape(-1, 4, 2)


def draw_rings(raster: Raster) -> None:
    """Range rings every 10 m."""
    angle = np.linspace(0, 2 * np.pi, 181)
    circle = np.stack([np.cos(angle), np.sin(angle)], -1)
    for distance in np.arange(10.0, raster.radius + 0.1, 10.0):
        raster.line(distance * circle, palette.RING, 1.0, 0.9)


def draw_ranges(raster: Raster) -> None:
    """The distance on each ring [m]."""
    for distance in np.arange(10.0, raster.radius + 0.1, 10.0):
        raster.number(np.array([-0.7071, -0.7071]) * distance, int(distance), (128, 134, 146))


def draw_cloud(raster: Raster, scan: Scan, is_ground: Bool, label: U8, truth: Truth | None = None) -> None:
    """The cloud: `is_ground` (n,) as judged, `label` (n,) the colour code of its cluster, 0 none."""
    T = scan.T_world_sensor
    points = scan.points
    with np.errstate(invalid="ignore", over="ignore"):  # odd points are legal; they are not drawn
        height = points @ T[2, :3].astype(np.float32) + np.float32(SENSOR_HEIGHT)
    height = np.nan_to_num(height, nan=0.0, posinf=0.0, neginf=0.0)
    kind = truth.kind if truth else None
    codes = palette.point_codes(is_ground, height, label, kind, truth.is_ground if truth else None)
    colours = palette.point_table()[codes]
    above = codes < 128
    raster.dots(points[~above, :2], colours[~above])
    raster.dots(points[above, :2], colours[above], 2)


def draw_truth(raster: Raster, flat: Flat, truth: Truth) -> None:
    """True boxes, dashed where hidden; those out of range are left out."""
    for corners, seen in zip(flat.outlines(truth.boxes), truth.visibility, strict=True):
        if seen == Visibility.HIDDEN:
            raster.dashes(corners, palette.HIDDEN_BOX)
        elif seen != Visibility.OUT_OF_RANGE:
            raster.line(corners, palette.TRUE_BOX, 1.2, closed=True)


def draw_ego(raster: Raster) -> None:
    """The vehicle that carries the sensor."""
    raster.line(EGO_SHAPE, palette.EGO, 1.6, closed=True)
