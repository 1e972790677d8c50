"""The bird's-eye picture of a frame: cloud by class, true boxes, detections, tracks with tails."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from datmo.arrays import F64, U8, Array, Bool
from datmo.messages import Frame, Scan, Status, Truth
from sim.picture import palette
from sim.picture.birdseye import (
    PIXELS,
    RADIUS,
    Flat,
    draw_cloud,
    draw_ego,
    draw_ranges,
    draw_rings,
    draw_truth,
)
from sim.picture.raster import Raster

TAIL = 40

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
    draw_rings(raster)
    label = np.where(frame.clusters.label >= 0, 64 + frame.clusters.label % 64, 0).astype(np.uint8)
    draw_cloud(raster, frame.scan, frame.ground.is_ground, label, truth)
    draw_ranges(raster)
    flat = Flat(frame.scan)
    if truth is not None:
        draw_truth(raster, flat, truth)
    width, alpha = (1.5, 1.0) if truth is None else (1.0, 0.75)  # the detections are all there is to see
    for corners in flat.outlines(frame.boxes):
        raster.line(corners, palette.DETECTION, width, alpha, closed=True)
    _draw_tracks(raster, flat, frame, tails or {})
    draw_ego(raster)
    return raster.image


def ground_eye(scan: Scan, is_ground: Bool, radius: float = RADIUS, pixels: int = PIXELS) -> U8:
    """The picture (pixels, pixels, 3) of a segmentation: ground grey-brown, the rest in one colour."""
    raster = Raster(pixels, radius)
    draw_rings(raster)
    draw_cloud(raster, scan, is_ground, np.full(len(scan), palette.REST, np.uint8))
    draw_ranges(raster)
    draw_ego(raster)
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


def _draw_tracks(raster: Raster, flat: Flat, frame: Frame, tails: Tails) -> None:
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
        raster.number(np.array([corner[0], outlines[i, :, 1].mean()]), identity, colour)


def _speed(velocity: F64) -> float:
    speed = float(np.hypot(velocity[0], velocity[1]))
    return speed if np.isfinite(speed) else 0.0
