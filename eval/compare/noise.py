"""Noise of range, from how neighbouring returns of one ring scatter about a smooth curve."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, I64, U8

RUN = 11
"""Returns of a stretch."""
SLOPE = 0.15
"""Stretches over which range changes by more than this share are left out."""


def residuals(distance: F64, ring: U8, turn: F64, step: float) -> tuple[F64, I64]:
    """Standard deviation of range about a parabola in each stretch of `RUN` returns without a gap.

    Args:
        distance: (n,) [m]. ring: (n,). turn: (n - 1,) angle between neighbours [rad].
        step: its mean [rad].

    Returns:
        (w,) [m] and the returns of each stretch (w, RUN).
    """
    start = np.arange(0, len(distance) - RUN, RUN)
    rows = start[:, None] + np.arange(RUN)
    whole = ring[rows[:, 0]] == ring[rows[:, -1]]
    whole &= np.abs(turn[rows[:, :-1]].sum(1) - (RUN - 1) * step) < step
    whole &= np.ptp(distance[rows], axis=1) < SLOPE * distance[rows].mean(1)
    rows = rows[whole]
    curve = np.vander(np.linspace(-1, 1, RUN), 3)
    off = np.eye(RUN) - np.einsum("ij,jk->ik", curve, np.linalg.pinv(curve))
    error = np.einsum("ij,nj->ni", off, distance[rows])
    return np.sqrt((error**2).sum(1) / (RUN - 3)), rows
