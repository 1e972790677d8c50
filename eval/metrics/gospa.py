"""GOSPA: localisation, misses and false objects in one distance (Rahmathullah 2017, alpha = 2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, I64, Bool
from eval.metrics.matching import assign

CUTOFF = 4.0
POWER = 2


@dataclass(frozen=True)
class Gospa:
    """One scan: distance [m] and its parts [m²]; distance² is their sum."""

    distance: float
    localisation: float
    missed: float
    false: float


def gospa(distance: F64, allowed: Bool | None = None) -> Gospa:
    """GOSPA with p = 2, c = 4 m, alpha = 2; both sets empty gives 0.

    Args:
        distance: (k, m) [m] between k true objects and m reported ones.
        allowed: (k, m) pairs that may be assigned; None allows all.
    """
    k, m = distance.shape
    near = distance < CUTOFF
    if allowed is not None:
        near &= allowed
    # To leave both of a pair alone costs c², so the best assignment lies where d < c; a pair
    # at cost d² - c² is worth taking exactly then.
    row, column = _cheapest(distance, near)
    localisation = float(np.sum(distance[row, column] ** POWER))
    alone = CUTOFF**POWER / 2
    missed, false = alone * (k - len(row)), alone * (m - len(row))
    return Gospa(float(np.sqrt(localisation + missed + false)), localisation, missed, false)


def _cheapest(distance: F64, near: Bool) -> tuple[I64, I64]:
    """Pairs of least total cost where leaving a pair alone costs c²."""
    cost = np.where(near, distance**POWER, CUTOFF**POWER)
    row, column = assign(cost, np.ones_like(near))
    kept = near[row, column]
    return row[kept], column[kept]
