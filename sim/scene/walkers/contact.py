"""Bodies do not pass through one another: what is left of velocities that would."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, Bool
from sim.scene.walkers.boxes import Boxes

ROUNDS = 4
PUSH = 1.5  # most that a body is pushed out of another [m/s]
SIDE = 0.4  # kept between a person's middle and the side of a vehicle or thing [m]


def part(position: F64, velocity: F64, yaw: F64, half: F64, mobile: Bool, dt: float) -> F64:
    """Velocities (n, 2) after which no two people overlap.

    A body is the ellipse with semi-axes `half` (n, 2) [m] at its heading `yaw` (n,). Along the line
    between two middles each reaches as far as its support function; the rest of the gap is the most
    by which they may come nearer in `dt`. Who is not `mobile` (n,) leaves all of it to the other.
    """
    v = velocity.copy()
    near = np.hypot(*(position[:, None] - position[None]).transpose(2, 0, 1)) < 2 * half.max(initial=0) + 0.5
    pairs = [(i, j) for i, j in zip(*np.nonzero(np.triu(near, 1)), strict=True) if mobile[i] or mobile[j]]
    for _ in range(ROUNDS):
        for i, j in pairs:
            n = position[i] - position[j]
            d = float(np.hypot(n[0], n[1]))
            n = n / d if d > 1e-6 else np.array([1.0, 0.0])
            room = d - _reach(n, yaw[i], half[i]) - _reach(n, yaw[j], half[j])
            closing = float(((v[i] - v[j]) * n).sum())
            lack = min(-room / dt, PUSH) - closing
            if lack > 0:
                share = 1.0 / (float(mobile[i]) + float(mobile[j]))
                v[i] += n * (lack * share * mobile[i])
                v[j] -= n * (lack * share * mobile[j])
    return v


def keep_out(position: F64, velocity: F64, boxes: Boxes, dt: float) -> F64:
    """Velocities (n, 2) after which nobody is nearer than SIDE to the side of a box."""
    v = velocity.copy()
    if not len(boxes):
        return v
    gap = boxes.gap(position)
    distance = np.hypot(gap[..., 0], gap[..., 1])
    for i, j in zip(*np.nonzero(distance < SIDE + 1.0), strict=True):
        n = gap[i, j] / max(distance[i, j], 1e-9)
        opening = float(((v[i] - boxes.velocity[j]) * n).sum())
        lack = min((SIDE - distance[i, j]) / dt, PUSH) - opening
        if lack > 0:
            v[i] += n * lack
    return v


def _reach(n: F64, yaw: float, half: F64) -> float:
    c, s = np.cos(yaw), np.sin(yaw)
    return float(np.hypot(half[0] * (n[0] * c + n[1] * s), half[1] * (n[1] * c - n[0] * s)))
