"""Rectangles along their own axes to boxes in the world, with the covariance of centre and yaw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.boxes.complete import Whole

STEP_STD = np.deg2rad(0.5)  # of a search in steps of a degree, at the least
SIDE_STD = 0.05  # [m] how far a side strays from a line


@dataclass(frozen=True)
class Upright:
    """What `Detections` holds of the boxes' plan: see there."""

    center: F64
    size: F64
    yaw: F64
    seen: F64
    cov: F64


def to_axes(point: F64, angle: F64) -> F64:
    """A place (2,) [m, world] along axes at each angle (k,): (k, 2) [m]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([c * point[0] + s * point[1], c * point[1] - s * point[0]])


def upright(seen: F64, whole: Whole, angle: F64) -> Upright:
    """Boxes of the whole rectangles; yaw in [-pi/2, pi/2).

    The std of the yaw is the noise of the search over the longest side that was seen, and a quarter turn
    where the length may as well lie across.

    Args:
        seen: (k, 4) x0, x1, y0, y1 along axes at `angle` (k,) [rad] [m].
    """
    size, turned, middle = whole.size, whole.turned, (whole.extent[:, ::2] + whole.extent[:, 1::2]) / 2
    c, s = np.cos(angle), np.sin(angle)
    center = np.column_stack([c * middle[:, 0] - s * middle[:, 1], s * middle[:, 0] + c * middle[:, 1]])
    about = seen - middle[:, [0, 0, 1, 1]]
    # The length along y: the axes turn back by a quarter, x' = -y, y' = x.
    back = np.column_stack([-about[:, 3], -about[:, 2], about[:, 0], about[:, 1]])
    long = np.maximum(seen[:, 1] - seen[:, 0], seen[:, 3] - seen[:, 2])
    R = np.stack([c, -s, s, c], 1).reshape(-1, 2, 2)
    cov = np.zeros((len(seen), 3, 3))
    cov[:, :2, :2] = np.einsum("kia,ka,kja->kij", R, whole.var, R)
    cov[:, 2, 2] = STEP_STD**2 + (SIDE_STD / np.maximum(long, SIDE_STD)) ** 2 + whole.turn * (np.pi / 2) ** 2
    return Upright(
        center,
        np.where(turned[:, None], size[:, ::-1], size),
        np.where(turned, angle - np.pi / 2, angle),
        np.where(turned[:, None], back, about),
        cov,
    )
