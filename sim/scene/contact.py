"""Actors on the ground: height, pitch and roll from the heights under wheels and feet."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, Array
from sim.scene.terrain import Terrain

WHEELBASE = 0.6  # share of the length between the axles
TRACK = 0.85  # share of the width between the wheels of an axle
TYRE = ((-0.4, 1), (-0.2, 2), (0.0, 3), (0.2, 2), (0.4, 1))  # a tyre rolls over what is shorter: (m, weight)


def stand(
    terrain: Terrain,
    xy: F64,
    yaw: F64,
    length: Array | float,
    width: Array | float,
    upright: Array | bool = False,
) -> F64:
    """T_world_actor (..., 4, 4) of actors that stand on the ground at xy with heading yaw.

    A vehicle lies on the plane z = c + a x + b y (heading frame) that fits the heights h under its
    four wheels best in the least-squares sense. The wheels are placed evenly about the centre,
    so the normal equations part: c = mean h, a = sum x h / sum x^2, b = sum y h / sum y^2. Each h is a
    weighted mean over the tyre's length, so the pose moves as continuously as the ground does.
    The heading seen from above is exactly `yaw`. Persons stand upright, at the mean height
    under a footprint of theirs.

    Args:
        xy: (..., 2) [m, world]. yaw: (...) [rad, world].
        length, width: of the actor's box [m]; broadcast against yaw.
        upright: True for actors that do not tilt (pedestrians); broadcast against yaw.
    """
    xy, yaw = np.asarray(xy, float), np.asarray(yaw, float)
    x = np.broadcast_to(np.asarray(length, float) * WHEELBASE / 2, yaw.shape)
    y = np.broadcast_to(np.asarray(width, float) * TRACK / 2, yaw.shape)
    front_left, front_right, rear_left, rear_right = (
        _under_wheel(terrain, xy, yaw, i * x, j * y) for i in (1, -1) for j in (1, -1)
    )
    height = (front_left + front_right + rear_left + rear_right) / 4
    rise = (front_left + front_right - rear_left - rear_right) / (4 * x)
    bank = (front_left + rear_left - front_right - rear_right) / (4 * y)
    tilts = ~np.broadcast_to(np.asarray(upright, bool), yaw.shape)
    return _pose(xy, yaw, height, np.where(tilts, rise, 0.0), np.where(tilts, bank, 0.0))


def _under_wheel(terrain: Terrain, xy: F64, yaw: F64, x: F64, y: F64) -> F64:
    """Mean height (...) of the ground under a wheel at (x, y) of the heading frame."""
    c, s = np.cos(yaw), np.sin(yaw)
    total = np.zeros(yaw.shape)
    for offset, weight in TYRE:
        ahead = x + offset * np.minimum(np.abs(x), 1.0)  # the contact of a short actor is short
        place = np.stack([xy[..., 0] + c * ahead - s * y, xy[..., 1] + s * ahead + c * y], -1)
        total += weight * terrain.height_at(place.reshape(-1, 2)).reshape(yaw.shape)
    return np.asarray(total / sum(weight for _, weight in TYRE))


def _pose(xy: F64, yaw: F64, height: F64, rise: F64, bank: F64) -> F64:
    """T_world_actor of the tangent plane with slopes `rise` ahead and `bank` to the left."""
    c, s = np.cos(yaw), np.sin(yaw)
    ahead = np.stack([c, s, rise], -1)
    ahead /= np.sqrt(1 + rise**2)[..., None]
    up = np.stack([-c * rise + s * bank, -s * rise - c * bank, np.ones_like(rise)], -1)
    up /= np.sqrt(1 + rise**2 + bank**2)[..., None]
    T_world_actor = np.zeros((*yaw.shape, 4, 4))
    T_world_actor[..., :3, 0] = ahead
    T_world_actor[..., :3, 1] = np.cross(up, ahead)
    T_world_actor[..., :3, 2] = up
    T_world_actor[..., :2, 3] = xy
    T_world_actor[..., 2, 3] = height
    T_world_actor[..., 3, 3] = 1
    return T_world_actor
