"""Global nearest neighbour: the one likeliest joint event, taken as certain."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

from datmo.arrays import F64
from datmo.tracks.measurement.pairs import Pairs


def nearest(pairs: Pairs, weight: F64, none: F64, boxes: int) -> tuple[F64, F64]:
    """Hard beta (p,) and missed (t,), each 0 or 1.

    Maximises the sum of log weights over all ways to give each track one box at most and each box
    to one track at most. What a box gains is counted against missing it, log(weight / none), and
    a cell that gains nothing is a miss: the zeros serve as each track's dummy.

    Args:
        pairs: gated pairs. boxes: number of boxes.
        weight: (p,) of each pair, > 0. none: (t,) of no box, > 0.
    """
    gain = np.zeros((len(none), boxes))
    gain[pairs.track, pairs.box] = np.maximum(np.log(weight) - np.log(none[pairs.track]), 0)
    chosen = np.zeros(gain.shape, np.bool_)
    chosen[linear_sum_assignment(gain, maximize=True)] = True
    chosen &= gain > 0
    beta = chosen[pairs.track, pairs.box].astype(np.float64)
    return beta, np.asarray(~chosen.any(axis=1), np.float64)
