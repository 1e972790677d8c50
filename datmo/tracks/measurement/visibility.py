"""What the rays of a scan say about a place: seen, hidden or empty."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, Bool
from datmo.messages import Sight

HEIGHTS = np.array([-0.2, 0.1, 0.35])  # where a box is looked for, in heights from its middle
SIDES = np.array([-0.35, 0.0, 0.35])  # and across the line of sight, in extents
SLACK = 0.3  # [m] a surface this much nearer or farther is still the place itself


def shares(sight: Sight, center: F64, size: F64, yaw: F64, cov: F64) -> tuple[F64, F64]:
    """Share of each predicted box that should be seen, and share that is seen to be empty.

    Looked for at the five sigma points of the place, three heights and three places across each.

    Args:
        sight: how far the rays saw.
        center: (t, 3) [m, world]. size: (t, 3) [m]. yaw: (t,) [rad]. cov: (t, 2, 2) [m²].

    Returns:
        visible (t,), empty (t,), each 0..1; empty <= visible. Where no ray was fired a place
        counts as visible: nothing excuses its absence.
    """
    if len(center) == 0:
        return np.zeros(0), np.zeros(0)
    step = np.sqrt(2) * np.linalg.cholesky(cov + 1e-6 * np.eye(2)).swapaxes(1, 2)
    sigma = np.concatenate([np.zeros((len(center), 1, 2)), step, -step], 1)
    places = np.repeat(center[:, None], 5, axis=1)
    places[..., :2] += sigma
    hidden, empty, known = (k.sum(axis=1) for k in looks(sight, places, size, yaw))
    share = np.where(known > 0, 1 - hidden / np.maximum(known, 1), 1.0)
    return share, np.where(known > 0, empty / np.maximum(known, 1), 0.0)


def looks(sight: Sight, center: F64, size: F64, yaw: F64) -> tuple[F64, F64, F64]:
    """Of the rays towards a box at each of some places: how many end before it, beyond it, or at all.

    Args:
        sight: how far the rays saw.
        center: (t, m, 3) places of t boxes [m, world]. size: (t, 3) [m]. yaw: (t,) [rad].

    Returns:
        hidden, empty, known, (t, m) each: numbers of places looked for, of `HEIGHTS` times `SIDES`.
    """
    t, m = center.shape[:2]
    toward = center[:, 0, :2] - sight.T_world_sensor[:2, 3]
    bearing = np.arctan2(toward[:, 1], toward[:, 0])
    c, s = np.abs(np.cos(yaw - bearing)), np.abs(np.sin(yaw - bearing))
    depth, across = (size[:, 0] * c + size[:, 1] * s) / 2, size[:, 0] * s + size[:, 1] * c
    side = np.stack([-np.sin(bearing), np.cos(bearing)], 1)
    sideways = (SIDES[None] * across[:, None])[..., None] * side[:, None]
    places = np.zeros((t, m, len(SIDES), len(HEIGHTS), 3))
    places[..., :2] = (center[:, :, None, :2] + sideways[:, None])[:, :, :, None]
    places[..., 2] = center[:, :, None, None, 2] + (HEIGHTS[None] * size[:, 2, None])[:, None, None]
    kind = judge(sight, places.reshape(-1, 3), np.repeat(depth, places[0].size // 3))
    hidden, empty, known = (k.reshape(t, m, -1).sum(axis=2).astype(float) for k in kind)
    return hidden, empty, known


def judge(sight: Sight, places: F64, depth: F64, slack: float = SLACK) -> tuple[Bool, Bool, Bool]:
    """Whether each place (n, 3) lies behind all that is seen there, before it, and whether any ray tells.

    Args:
        sight: how far the rays saw.
        places: (n, 3) [m, world].
        depth: (n,) half the extent of what is looked for along the ray [m].
        slack: a surface this much nearer or farther is still the place itself [m].
    """
    distance, near, far = sight.look(places)
    known = np.isfinite(near)
    within = distance <= sight.far.max(initial=0)  # beyond all that was seen nothing hides: it has left
    hidden = known & within & (np.where(known, far, np.inf) < distance - depth - slack)
    empty = known & (np.where(known, near, -np.inf) > distance + depth + slack)
    return hidden, empty, known
