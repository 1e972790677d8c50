"""The bird's-eye picture of a scan and its truth: cloud by class, true boxes, the ego."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, U8, Array
from datmo.geometry import corners_bev, inverse, transform
from datmo.messages import Boxes, Kind, Scan, Truth, Visibility
from sim.canvas import Canvas

EGO = np.array([[2.2, 0.9], [2.6, 0.0], [2.2, -0.9], [-2.2, -0.9], [-2.2, 0.9]])
CLASS_COLOUR = np.full((32, 3), (150, 150, 160), np.uint8)
CLASS_COLOUR[[Kind.CAR, Kind.VAN]] = (90, 160, 255)
CLASS_COLOUR[[Kind.TRUCK, Kind.BUS]] = (170, 120, 255)
CLASS_COLOUR[[Kind.PEDESTRIAN]] = (255, 90, 110)
CLASS_COLOUR[[Kind.MOTORCYCLE, Kind.BICYCLE]] = (255, 150, 60)
CLASS_COLOUR[[Kind.ROAD]] = (84, 84, 92)
CLASS_COLOUR[[Kind.SIDEWALK]] = (112, 92, 112)
CLASS_COLOUR[[Kind.FIELD]] = (92, 108, 66)
CLASS_COLOUR[[Kind.VEGETATION, Kind.TRUNK]] = (60, 150, 70)
CLASS_COLOUR[[Kind.FALSE_RETURN]] = (230, 230, 90)
TRUE_BOX, HIDDEN_BOX = (235, 235, 235), (150, 120, 60)


def stage(radius: float = 50.0, pixels: int = 800) -> Canvas:
    """An empty picture around the sensor with range rings and the ego."""
    canvas = Canvas(pixels, radius)
    canvas.rings()
    canvas.line(EGO, (120, 230, 140), closed=True, size=2)
    return canvas


def to_picture(scan: Scan, places: Array) -> F64:
    """Places (n, 3) [m, world] in the picture's own plane (n, 2) [m, sensor]."""
    return transform(inverse(scan.T_world_sensor), places)[:, :2]


def outline(scan: Scan, boxes: Boxes, row: int) -> F64:
    """Corners (4, 2) [m, sensor] of one box."""
    corners = corners_bev(boxes.center[row, None], boxes.size[row, None], boxes.yaw[row, None])[0]
    return to_picture(scan, np.c_[corners, np.full(4, boxes.center[row, 2])])


def draw_true_boxes(canvas: Canvas, scan: Scan, truth: Truth) -> None:
    """True boxes in white, those of hidden objects in brown."""
    for row in range(len(truth.boxes)):
        if truth.visibility[row] != Visibility.OUT_OF_RANGE:
            hidden = truth.visibility[row] == Visibility.HIDDEN
            canvas.line(outline(scan, truth.boxes, row), HIDDEN_BOX if hidden else TRUE_BOX, closed=True)


def picture(scan: Scan, truth: Truth, radius: float = 50.0, pixels: int = 800) -> U8:
    """The bird's-eye picture (pixels, pixels, 3), forward up."""
    canvas = stage(radius, pixels)
    order = np.argsort(~truth.is_ground, kind="stable")  # objects lie on top of the ground
    canvas.points(scan.points[order, :2], CLASS_COLOUR[truth.kind[order]])
    draw_true_boxes(canvas, scan, truth)
    return canvas.image
