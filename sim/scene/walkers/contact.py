"""Bodies do not pass through one another: what is left of velocities that would."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, Bool
from sim.scene.walkers.boxes import Boxes

ROUNDS = 4
PUSH = 0.5  # most that a body is pushed out of another [m/s]
GAP = 0.01  # kept between boxes, for they turn, too [m]
ASIDE = 0.5  # who is held up steps to the right with this share of the speed it gives up
NEAR = 3.0  # people farther apart than this cannot touch [m]
SIDE = 0.4  # kept between a person's middle and the side of a vehicle or thing [m]


def part(position: F64, velocity: F64, yaw: F64, half: F64, mobile: Bool, dt: float) -> F64:
    """Velocities (n, 2) after which no two people's boxes overlap.

    Boxes with half length and width `half` (n, 2) [m] at headings `yaw` (n,) are parted along the side
    that leaves most room; this room is the most by which they may come nearer in `dt`. Who is not
    `mobile` (n,) leaves all of it to the other.
    """
    v = velocity.copy()
    i, j = np.nonzero(np.triu(np.hypot(*(position[:, None] - position[None]).T).T < NEAR, 1))
    some = mobile[i] | mobile[j]
    i, j = i[some], j[some]
    normal, room = _between(position[i] - position[j], yaw[i], yaw[j], half[i], half[j])
    free = np.minimum((GAP - room) / dt, PUSH)
    for _ in range(ROUNDS):
        for a, b, n, least in zip(i, j, normal, free, strict=True):
            lack = least - float(((v[a] - v[b]) * n).sum())
            if lack > 0:
                share = lack / (float(mobile[a]) + float(mobile[b]))
                v[a] += _given_way(v[a], n, share) * mobile[a]
                v[b] += _given_way(v[b], -n, share) * mobile[b]
    return v


def _given_way(v: F64, n: F64, share: float) -> F64:
    """The change (2,) of one who is to move by `share` [m/s] along n; who walked against it sidesteps."""
    aside = min(ASIDE * share, -float((v * n).sum()))
    return n * share + np.array([-n[1], n[0]]) * max(aside, 0.0)


def _between(apart: F64, yaw_a: F64, yaw_b: F64, half_a: F64, half_b: F64) -> tuple[F64, F64]:
    """Unit vectors (p, 2) from b to a square to a side of one box, and the room (p,) [m] along them."""
    turn = np.stack([yaw_a, yaw_a + np.pi / 2, yaw_b, yaw_b + np.pi / 2], -1)
    axes = np.stack([np.cos(turn), np.sin(turn)], -1)
    along = (axes * apart[:, None]).sum(-1)
    reach = np.zeros_like(turn)
    for yaw, half in ((yaw_a, half_a), (yaw_b, half_b)):
        off = turn - yaw[:, None]
        reach += half[:, :1] * np.abs(np.cos(off)) + half[:, 1:] * np.abs(np.sin(off))
    room = np.abs(along) - reach
    rows, best = np.arange(len(room)), room.argmax(1)
    signs = np.where(along < 0, -1.0, 1.0)[rows, best]
    return axes[rows, best] * signs[:, None], room[rows, best]


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
