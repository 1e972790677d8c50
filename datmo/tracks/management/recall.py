"""Second stage: a track about to be confirmed may be one that was hidden (method.md 13)."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

from datmo.arrays import F64, I64
from datmo.geometry import wrap_angle
from datmo.tracks.bank import Bank
from datmo.tracks.config import TrackerConfig

LEAST_GAP = 0.25  # [s] a track seen more recently is not being looked for
SPEED_STD, TURN_STD, SIZE_STD, PLACE_STD = 2.0, 0.4, 0.3, 0.5
MOVING = 2.0  # [m/s] below which a heading says little


def recall(bank: Bank, mean: F64, P: F64, new: Bank, stamp: float, config: TrackerConfig) -> tuple[I64, I64]:
    """Rows (coasting track, new track) that are one object.

    Compared along and across the coasting track's heading, in speed, heading and size, each over
    what the coasting track's own covariance and `*_STD` allow.
    """
    wanted = np.flatnonzero(stamp - bank.seen > LEAST_GAP)
    if not config.recall or len(wanted) == 0 or len(new) == 0:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    old, fresh = mean[wanted][:, None], new.x[None, :, 0]
    c, s = np.cos(old[..., 2]), np.sin(old[..., 2])
    gap = fresh[..., :2] - old[..., :2]
    along, across = c * gap[..., 0] + s * gap[..., 1], c * gap[..., 1] - s * gap[..., 0]
    S = P[wanted][:, None] + new.P[None, :, 0]
    cross = 2 * c * s * S[..., 0, 1]
    var_along = c**2 * S[..., 0, 0] + s**2 * S[..., 1, 1] + cross + PLACE_STD**2
    var_across = s**2 * S[..., 0, 0] + c**2 * S[..., 1, 1] - cross + PLACE_STD**2
    moving = np.minimum(np.abs(old[..., 3]), np.abs(fresh[..., 3])) > MOVING
    turn = np.where(moving, wrap_angle(fresh[..., 2] - old[..., 2]), 0)
    size = np.log(new.size[None, :, :2] / bank.size[wanted][:, None, :2])
    cost = (
        along**2 / var_along
        + across**2 / var_across
        + (fresh[..., 3] - old[..., 3]) ** 2 / (S[..., 3, 3] + SPEED_STD**2)
        + turn**2 / (S[..., 2, 2] + TURN_STD**2)
        + np.sum(np.maximum(size, 0.3 * np.abs(size)) ** 2, axis=-1) / SIZE_STD**2
    )
    fits = cost <= config.recall_chi2
    rows, columns = linear_sum_assignment(np.where(fits, cost, 1e6))
    kept = fits[rows, columns]
    return wanted[rows[kept]], columns[kept]
