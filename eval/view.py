"""The bird's-eye picture of a frame: cloud by class, true boxes, detections, tracks with tails."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from datmo.arrays import F64, U8, Array
from datmo.geometry import corners_bev, inverse, transform
from datmo.messages import Boxes, Frame, Scan, Status, Truth, Visibility
from eval import palette
from eval.raster import Raster

RADIUS, PIXELS, TAIL = 50.0, 800, 40
SENSOR_HEIGHT = 1.73
EGO_SHAPE = np.array(
    [[2.3, 0.7], [2.6, 0.0], [2.3, -0.7], [1.9, -0.95], [-2.2, -0.95], [-2.2, 0.95], [1.9, 0.95]]
)

Tails = Mapping[int, Array]


def bird_eye(
    frame: Frame,
    truth: Truth | None = None,
    tails: Tails | None = None,
    radius: float = RADIUS,
    pixels: int = PIXELS,
) -> U8:
    """The picture (pixels, pixels, 3) around the sensor, forward up.

    Ground is grey-brown, lighter where higher. With `truth`, obstacles have the colour of their
    true kind, points of objects called ground are magenta, ground called obstacle is rust; without,
    each cluster has a colour. True boxes are white (dashed grey where hidden), detections thin
    yellow, confirmed tracks coloured by id with heading, tail and number; drifting ones dashed.

    Args:
        frame: what perception made of a scan.
        truth: of the same scan.
        tails: past places (m, 2) [m, world] of each track id.
        radius: half the extent [m]. pixels: side of the picture.
    """
    raster = Raster(pixels, radius)
    _draw_rings(raster)
    _draw_cloud(raster, frame, truth)
    _draw_ranges(raster)
    flat = _Flat(frame.scan)
    if truth is not None:
        _draw_truth(raster, flat, truth)
    width, alpha = (1.5, 1.0) if truth is None else (1.0, 0.75)  # the detections are all there is to see
    for corners in flat.outlines(frame.boxes):
        raster.line(corners, palette.DETECTION, width, alpha, closed=True)
    _draw_tracks(raster, flat, frame, tails or {})
    raster.line(EGO_SHAPE, palette.EGO, 1.6, closed=True)
    return raster.image


class BirdsEye:
    """Draws frame after frame and remembers the tails of the tracks.

    Args:
        radius: half the extent [m]. pixels: side of the picture. tail: scans a tail is long.
    """

    def __init__(self, radius: float = RADIUS, pixels: int = PIXELS, tail: int = TAIL) -> None:
        self._radius, self._pixels, self._length = radius, pixels, tail
        self._tails: dict[int, list[F64]] = {}

    def follow(self, frame: Frame) -> None:
        """Remember where the confirmed tracks of this frame are; forget those that ended."""
        tracks = frame.tracks
        shown = np.flatnonzero(tracks.confirmed())
        self._tails = {
            int(tracks.boxes.id[row]): [
                *self._tails.get(int(tracks.boxes.id[row]), [])[-self._length :],
                tracks.boxes.center[row, :2].copy(),
            ]
            for row in shown
        }

    def draw(self, frame: Frame, truth: Truth | None = None) -> U8:
        """The picture (pixels, pixels, 3) of a frame, tails included."""
        tails = {key: np.array(places) for key, places in self._tails.items()}
        return bird_eye(frame, truth, tails, self._radius, self._pixels)


class _Flat:
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


def _draw_rings(raster: Raster) -> None:
    angle = np.linspace(0, 2 * np.pi, 181)
    circle = np.stack([np.cos(angle), np.sin(angle)], -1)
    for distance in np.arange(10.0, raster.radius + 0.1, 10.0):
        raster.line(distance * circle, palette.RING, 1.0, 0.9)


def _draw_ranges(raster: Raster) -> None:
    for distance in np.arange(10.0, raster.radius + 0.1, 10.0):
        raster.number(np.array([-0.7071, -0.7071]) * distance, int(distance), (128, 134, 146))


def _draw_cloud(raster: Raster, frame: Frame, truth: Truth | None) -> None:
    scan = frame.scan
    T = scan.T_world_sensor
    points = scan.points
    with np.errstate(invalid="ignore", over="ignore"):  # odd points are legal; they are not drawn
        height = points @ T[2, :3].astype(np.float32) + np.float32(SENSOR_HEIGHT)
    height = np.nan_to_num(height, nan=0.0, posinf=0.0, neginf=0.0)
    label = np.where(frame.clusters.label >= 0, 64 + frame.clusters.label % 64, 0).astype(np.uint8)
    kind = truth.kind if truth else None
    codes = palette.point_codes(
        frame.ground.is_ground, height, label, kind, truth.is_ground if truth else None
    )
    colours = palette.point_table()[codes]
    above = codes < 128
    raster.dots(points[~above, :2], colours[~above])
    raster.dots(points[above, :2], colours[above], 2)


def _draw_truth(raster: Raster, flat: _Flat, truth: Truth) -> None:
    for corners, seen in zip(flat.outlines(truth.boxes), truth.visibility, strict=True):
        if seen == Visibility.HIDDEN:
            raster.dashes(corners, palette.HIDDEN_BOX)
        elif seen != Visibility.OUT_OF_RANGE:
            raster.line(corners, palette.TRUE_BOX, 1.2, closed=True)


def _draw_tracks(raster: Raster, flat: _Flat, frame: Frame, tails: Tails) -> None:
    tracks = frame.tracks
    rows = np.flatnonzero(tracks.confirmed())
    boxes = tracks.boxes.select(rows)
    outlines = flat.outlines(boxes)
    for i, row in enumerate(rows):
        identity = int(boxes.id[i])
        colour = palette.track_colour(identity)
        tail = tails.get(identity)
        if tail is not None and len(tail) > 1:
            raster.line(flat(tail), colour, 1.6, 0.7)
        if tracks.status[row] > Status.TRACKING:
            raster.dashes(outlines[i], colour, 2.0)
        else:
            raster.line(outlines[i], colour, 2.0, closed=True)
        reach = max(boxes.size[i, 0] / 2, 0.5) + 0.2 * _speed(boxes.velocity[i])
        ahead = boxes.center[i, :2] + reach * np.array([np.cos(boxes.yaw[i]), np.sin(boxes.yaw[i])])
        raster.line(flat(np.array([boxes.center[i, :2], ahead])), colour, 2.0)
        corner = outlines[i].max(0) + 14 / raster.scale
        raster.number((corner[0], outlines[i, :, 1].mean()), identity, colour)


def _speed(velocity: F64) -> float:
    speed = float(np.hypot(velocity[0], velocity[1]))
    return speed if np.isfinite(speed) else 0.0
