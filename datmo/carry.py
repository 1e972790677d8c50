"""Points of moving objects carried to the stamp, by the velocities that the tracker expects.

A sweep takes a tenth of a second. What was scanned at its beginning has moved on by its end: a car at 14 m/s
by 1.4 m, which no box around its points can know.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from pydantic import BaseModel, ConfigDict, Field

from datmo.arrays import F32, F64, I32, I64
from datmo.messages import Boxes, Clusters, Scan


class CarryConfig(BaseModel):
    """When points are carried to the stamp."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    enabled: bool = Field(True, description="whether points are carried at all")
    pad: float = Field(0.5, gt=0, description="a cluster's middle may lie this far outside the box [m]")
    slowest: float = Field(0.5, ge=0, description="a box predicted to move no faster stands [m/s]")


def carry(
    places: F64, scan: Scan, clusters: Clusters, predicted: Boxes, config: CarryConfig | None = None
) -> F64:
    """The points as they would lie had all been measured at the stamp.

    A cluster moves with the predicted box that it lies deepest in, at the time that it was scanned.

    Args:
        places: (n, 3) points of the scan [m, world]. predicted: boxes expected at the stamp [world].
        config: settings.

    Returns:
        (n, 3) [m, world]; `places` itself where nothing moves.
    """
    config = config or CarryConfig()
    speed = np.linalg.norm(predicted.velocity, axis=1)
    moving = predicted.select(speed > config.slowest)  # NaN compares False
    if not config.enabled or len(moving) == 0 or clusters.count == 0 or not scan.dt.any():
        return places
    owner = _owners(
        places, scan.dt, clusters.label, clusters.count,
        moving.center, moving.size, moving.yaw, moving.velocity, config.pad,
    )  # fmt: skip
    return np.asarray(_carried(places, scan.dt, clusters.label, owner, moving.velocity))


@njit(cache=True, nogil=True)
def _owners(
    places: F64,
    dt: F32,
    label: I32,
    count: int,
    center: F64,
    size: F64,
    yaw: F64,
    velocity: F64,
    pad: float,
) -> I64:
    """The box (count,) that each cluster moves with, -1 none."""
    mean, number = np.zeros((count, 3)), np.zeros(count)
    for i in range(len(label)):
        k = label[i]
        if k >= 0:
            mean[k, 0] += places[i, 0]
            mean[k, 1] += places[i, 1]
            mean[k, 2] += dt[i]
            number[k] += 1
    owner = np.full(count, -1, np.int64)
    for k in range(count):
        if number[k] == 0:
            continue
        x, y, t = mean[k] / number[k]
        deepest = 1.0
        for b in range(len(center)):
            dx, dy = x - center[b, 0] - velocity[b, 0] * t, y - center[b, 1] - velocity[b, 1] * t
            c, s = np.cos(yaw[b]), np.sin(yaw[b])
            along, across = abs(c * dx + s * dy), abs(c * dy - s * dx)
            depth = max(along / (size[b, 0] / 2 + pad), across / (size[b, 1] / 2 + pad))
            if depth < deepest:
                deepest, owner[k] = depth, b
    return owner


@njit(cache=True, nogil=True)
def _carried(places: F64, dt: F32, label: I32, owner: I64, velocity: F64) -> F64:
    out = places.copy()
    for i in range(len(label)):
        if label[i] >= 0 and owner[label[i]] >= 0:
            b = owner[label[i]]
            out[i, 0] -= velocity[b, 0] * dt[i]
            out[i, 1] -= velocity[b, 1] * dt[i]
    return out
