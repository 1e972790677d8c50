"""Which ends of a box that was seen in part are real, as the rays beside it tell."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, I64, Bool
from datmo.geometry import axes_of
from datmo.messages import Sight
from datmo.tracks.measurement.visibility import judge

CORNERS = np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]])  # of a box, by side
BESIDE, BEYOND = np.deg2rad(0.75), 0.2  # past a corner, at the least [rad], [m], rays tell whether it is real
HEIGHTS = np.array([-0.15, 0.0, 0.15, 0.3])  # where, in heights from the middle; not all rows have rays
END_SLACK = 0.3  # [m] so much farther than the corner they must go
FACE = np.deg2rad(0.75)  # a face of less is not seen as one


def real_ends(sight: Sight, center: F64, axes: F64, seen: F64, height: F64) -> Bool:
    """(p, 2, 2) by side and end (back, front): whether what was seen really ends there.

    So it does when rays pass beside the outermost corner of that end, to either hand, and meet
    nothing until well behind it. A corner that something nearer cuts off tells nothing, and a far one only
    where the face that leads to it was seen: an end behind the body itself cannot be told from the near one.

    Args:
        center: (p, 3) where it was when the rays came by [m, world]. axes: (p, 2, 2) unit vectors along and
            across. seen: (p, 2) extent [m]. height: (p,) [m].
    """
    real, rows = np.zeros((len(center), 2, 2), np.bool_), np.arange(len(center))
    middle = center[:, :2] - sight.T_world_sensor[:2, 3]
    corners = np.einsum("ca,pa,pai->pci", CORNERS, seen / 2, axes) + middle[:, None]
    distance = np.hypot(corners[..., 0], corners[..., 1])
    cross = middle[:, None, 0] * corners[..., 1] - middle[:, None, 1] * corners[..., 0]
    bearing = np.arctan2(cross, np.einsum("pi,pci->pc", middle, corners))
    for hand in (-1.0, 1.0):
        outer = np.argmax(hand * bearing, axis=1)
        passed = _passed(sight, corners[rows, outer], hand, center[:, 2], height)
        for side in range(2):
            other = _other_end(outer, side)
            face = hand * (bearing[rows, outer] - bearing[rows, other]) > FACE
            told = face | (distance[rows, outer] < distance[rows, other])
            real[rows, side, (CORNERS[outer, side] > 0).astype(int)] |= passed & told
    return real


def anchor(real: Bool) -> F64:
    """(..., 2) by side, of (..., 2, 2): the one end that is real, 1 front, -1 back; 0 if both or none."""
    return np.asarray(real[..., 1].astype(float) - real[..., 0])


def moved_middle(held: F64, change: F64, yaw: F64) -> F64:
    """(p, 2) [m, world] by which the middle of a box moves whose sides change while one end stays.

    Args:
        held: (p, 2) that end, as of `anchor`. change: (p, 2) of length and width [m]. yaw: (p,).
    """
    return np.asarray(np.einsum("pa,pai->pi", -held * change / 2, axes_of(yaw)))


def _other_end(corner: I64, side: int) -> I64:
    """The corner at the other end of a side, in the order of `CORNERS`."""
    return np.asarray(corner ^ (2 >> side))


def _passed(sight: Sight, corner: F64, hand: float, z: F64, height: F64) -> Bool:
    """(p,) whether rays pass a corner (p, 2) [m, from the sensor] on the one hand and go on behind it."""
    x, y = corner.T
    beside = hand * np.maximum(BESIDE, BEYOND / np.maximum(np.hypot(x, y), 1.0))
    c, s = np.cos(beside), np.sin(beside)
    places = np.zeros((len(corner), len(HEIGHTS), 3))
    places[..., 0] = (sight.T_world_sensor[0, 3] + c * x - s * y)[:, None]
    places[..., 1] = (sight.T_world_sensor[1, 3] + s * x + c * y)[:, None]
    places[..., 2] = z[:, None] + HEIGHTS * height[:, None]
    _, empty, _ = judge(sight, places.reshape(-1, 3), np.zeros(places[..., 0].size), END_SLACK)
    return np.asarray(empty.reshape(-1, len(HEIGHTS)).any(axis=1))
