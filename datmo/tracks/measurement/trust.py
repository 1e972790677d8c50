"""How far a box is to be trusted, by its score.

A detector's score tells how likely a box is real, and how exactly it is placed: on KITTI, cars that
PointRCNN scores 3 are real half the time and three times as far off as those it scores 10, of which
99 % are real.
"""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, Array
from datmo.tracks.config import TrackerConfig

MOST_LOGIT = 20.0  # so that a trust of exactly 1 is that of scores which tell nothing


def are_logits(score: Array) -> bool:
    """Whether scores (k,) cannot be shares: one lies outside 0..1."""
    return bool(((score < 0) | (score > 1)).any())


def trust(score: Array, logits: bool, config: TrackerConfig) -> F64:
    """Probability (k,) that a box is real, by its score; 1 where scores tell nothing of it."""
    if not logits:
        return np.ones(len(score))
    z = config.logit_slope * (np.asarray(score, float) - config.logit_half)
    return np.asarray(1 / (1 + np.exp(-np.clip(z, -MOST_LOGIT, MOST_LOGIT))))


def noise_factor(trust: F64, config: TrackerConfig) -> F64:
    """How many times the usual deviation a box (k,) has."""
    return np.asarray(1 + config.doubt_noise * np.sqrt(1 - trust))


def evidence(trust: F64) -> F64:
    """-log of the probability that a box (k,) is not real; adds up over boxes of one track.

    Nothing where scores do not tell (trust 1): then hits are counted alone.
    """
    return np.asarray(np.where(trust < 1, -np.log1p(-np.minimum(trust, 1 - 1e-12)), 0.0))
