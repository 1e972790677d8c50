"""Which way to walk around what stands in the way.

A person takes the clear heading with the least turn on the side of the shorter way, and where none is
clear the one that comes nearest to the goal before something stands in the way; and no more speed
than leaves a relaxation time before it. The latter two are the rules of M. Moussaid, D. Helbing,
G. Theraulaz, How simple rules determine pedestrian behavior and crowd disasters, PNAS 108 (2011)
6884; the first keeps people from stopping before a long wall.
"""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from sim.scene.walkers.boxes import Boxes
from sim.scene.walkers.social import TAU

HORIZON = 10.0  # d_max [m], 2011
FIELD = 105.0  # to either side [deg]; 75 in 2011, but who faces a wall shall find the way along it
STEP = 5.0  # between the headings looked at [deg]
KEEP = 0.7  # from the sides of what is in the way to a person's middle [m]


def look(position: F64, way: F64, goal: F64, pace: float, boxes: Boxes) -> F64:
    """The desired velocity (2,) [m/s]: along `way`, or, where something stands in it, around that.

    Args:
        position: (2,) [m, world]. way: unit vector (2,). goal: (2,) where it leads in the end; what is
            farther away does not matter. pace: desired speed [m/s]. boxes: that stand about.
    """
    to_goal = goal - position
    far = float(np.hypot(to_goal[0], to_goal[1]))
    near = np.hypot(*(boxes.center - position).T) - np.hypot(*boxes.half.T) < min(far, HORIZON) + KEEP
    if not near.any():
        return way * pace
    turns = np.radians(np.arange(-FIELD, FIELD + STEP / 2, STEP))
    heading = np.arctan2(to_goal[1], to_goal[0]) + turns
    e = np.stack([np.cos(heading), np.sin(heading)], -1)
    each = _free(position, e, boxes.only(near))
    free = each.min(1)
    clear = free >= min(far, HORIZON)
    middle = len(turns) // 2
    if clear[middle]:
        return way * pace
    side = _side(position, goal, boxes.only(near), int(each[middle].argmin()))
    detour = HORIZON**2 + free**2 - 2 * HORIZON * free * np.cos(turns)  # squared, 2011
    order = np.where(clear, np.abs(turns) + np.pi * (turns * side < 0), 100.0 + detour)
    best = int(np.argmin(np.round(order, 9)))
    return np.asarray(e[best] * min(pace, max(free[best] / TAU, 0.3 * pace)))


def _side(position: F64, goal: F64, boxes: Boxes, row: int) -> float:
    """On which side of a box the way to the goal is shorter: 1 left, -1 right."""
    signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    one = boxes.only(np.arange(len(boxes)) == row)
    corners = one.center + one.local(signs[:, None] * (one.half + KEEP), -1.0)[:, 0]
    there, ahead = corners - position, goal - position
    across = ahead[0] * there[:, 1] - ahead[1] * there[:, 0]
    left, right = int(across.argmax()), int(across.argmin())
    way = np.hypot(*there.T) + np.hypot(*(goal - corners).T)
    return 1.0 if way[left] < way[right] else -1.0


def _free(position: F64, e: F64, boxes: Boxes) -> F64:
    """How far (h, b) one may go in each direction e (h, 2) before each box, at most HORIZON [m]."""
    start = boxes.local(position - boxes.center)
    ray = boxes.local(np.broadcast_to(e[:, None], (len(e), len(boxes), 2)))
    ray = np.where(np.abs(ray) < 1e-12, 1e-12, ray)
    half = boxes.half + KEEP
    enter, leave = np.sort(np.stack([(-half - start) / ray, (half - start) / ray]), axis=0)
    first, last = enter.max(-1), leave.min(-1)
    hit = np.where((first <= last) & (last > 0), np.maximum(first, 0.0), HORIZON)
    gap = boxes.gap(position[None])[0]  # whoever stands too near may go where it gets no nearer
    outward = (gap * e[:, None]).sum(-1) >= 0
    inside = (np.abs(start) < half).all(-1)
    return np.asarray(np.minimum(np.where(inside & outward, HORIZON, hit), HORIZON))
