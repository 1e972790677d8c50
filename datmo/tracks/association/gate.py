"""Which boxes a track may be given, and how likely each is (2.55-2.58; method.md section 12)."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, I64
from datmo.geometry import half_turn
from datmo.tracks.config import TrackerConfig
from datmo.tracks.measurement.pairs import Pairs
from datmo.tracks.models import PSI

YAW_OUTLIER = 0.05  # share of sure yaws that are wrong all the same
SHAPE_FLOOR = 0.05  # a strange size alone never forbids a match
SIZE_SPREAD = 0.35  # deviation of the logarithm of a box's sides between scans


def near(mean: F64, P: F64, center: F64, reach: F64, config: TrackerConfig) -> tuple[I64, I64]:
    """Coarse pairs (track, box): closer than the gate's longest axis plus `reach` (t,) [m]."""
    S = P[:, :2, :2] + config.position_std**2 * np.eye(2)
    half, cross = (S[:, 0, 0] - S[:, 1, 1]) / 2, S[:, 0, 1]
    largest = (S[:, 0, 0] + S[:, 1, 1]) / 2 + np.sqrt(half**2 + cross**2)
    radius = np.sqrt(config.gate_chi2 * largest) + reach
    gap = mean[:, None, :2] - center[None, :, :2]
    close = np.einsum("tbi,tbi->tb", gap, gap) <= radius[:, None] ** 2
    track, box = np.nonzero(close)
    return track, box


def gate(pairs: Pairs, mean: F64, P: F64, config: TrackerConfig) -> Pairs:
    """The pairs with nu' S^-1 nu <= eta, S of the combined prediction, shared by all modes."""
    S = P[pairs.track][:, :2, :2] + pairs.R
    nu = pairs.z - mean[pairs.track, :2]
    pairs.distance = squared_distance(nu, S)
    pairs.volume = np.pi * config.gate_chi2 * np.sqrt(determinant(S))
    return pairs.select(pairs.distance <= config.gate_chi2)


def densities(pairs: Pairs, x: F64, P: F64) -> F64:
    """N(nu_ij; 0, S_j) of each pair under each mode, (p, m) [1/m²]."""
    S = P[pairs.track][:, :, :2, :2] + pairs.R[:, None]
    nu = pairs.z[:, None] - x[pairs.track][:, :, :2]
    return np.asarray(np.exp(-0.5 * squared_distance(nu, S)) / (2 * np.pi * np.sqrt(determinant(S))))


def yaw_ratios(pairs: Pairs, x: F64, P: F64) -> F64:
    """Likelihood of each pair's yaw under each mode over that of any yaw, (p, m); 1 without one."""
    sure = np.isfinite(pairs.yaw)
    nu = half_turn(np.where(sure, pairs.yaw, 0)[:, None] - x[pairs.track][:, :, PSI])
    s = P[pairs.track][:, :, PSI, PSI] + np.where(sure, pairs.yaw_var, 1)[:, None]
    fits = np.pi * np.exp(-0.5 * nu**2 / s) / np.sqrt(2 * np.pi * s)
    return np.where(sure[:, None], (1 - YAW_OUTLIER) * np.minimum(fits, np.pi) + YAW_OUTLIER, 1.0)


def size_ratios(pairs: Pairs, size: F64) -> F64:
    """How well each pair's extent suits the retained size, (p,) 0..1; smaller is no offence."""
    excess = np.maximum(np.log(np.maximum(pairs.seen, 0.1) / size[pairs.track][:, :2]), 0) / SIZE_SPREAD
    tall = np.exp(-0.5 * np.sum(excess**2, axis=1))
    return np.asarray(SHAPE_FLOOR + (1 - SHAPE_FLOOR) * tall)


def sure_yaw(pairs: Pairs, mean: F64, P: F64, config: TrackerConfig) -> F64:
    """Yaws (p,) with those beyond the yaw gate of the combined prediction taken out (NaN)."""
    sure = np.isfinite(pairs.yaw)
    nu = half_turn(np.where(sure, pairs.yaw, 0) - mean[pairs.track, PSI])
    s = P[pairs.track, PSI, PSI] + np.where(sure, pairs.yaw_var, 1)
    return np.where(sure & (nu**2 <= config.yaw_gate**2 * s), pairs.yaw, np.nan)


def determinant(S: F64) -> F64:
    """Determinant of (..., 2, 2)."""
    return np.asarray(S[..., 0, 0] * S[..., 1, 1] - S[..., 0, 1] * S[..., 1, 0])


def squared_distance(nu: F64, S: F64) -> F64:
    """nu' S^-1 nu of (..., 2) and symmetric (..., 2, 2)."""
    x, y = nu[..., 0], nu[..., 1]
    form = S[..., 1, 1] * x**2 - 2 * S[..., 0, 1] * x * y + S[..., 0, 0] * y**2
    return np.asarray(form / determinant(S))
