"""Noise of detections from their truth: what the tracker's configuration should say of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from scipy.optimize import linear_sum_assignment, minimize

from datmo.arrays import F64, Bool
from datmo.errors import ConfigError
from datmo.geometry import half_turn
from datmo.tracks import TrackerConfig
from eval.benchmark.kitti_tracks import Drive
from eval.benchmark.table import Rows
from eval.benchmark.tracker_real import LEAST_OVERLAP
from eval.benchmark.tracking_overlap import iou_3d

MAD = 1.4826  # median absolute deviation to standard deviation, for a normal law
CLASSES = 8
LEAST = 50  # detections that a fit takes


@dataclass(frozen=True)
class Residuals:
    """Detections (n) and, where matched to truth, how far each is off.

    Attributes:
        score: (n,). real: (n,) matched to a labelled object. off: (n, 3) along, across [m] and yaw [rad],
            NaN where not matched.
    """

    score: F64
    real: Bool
    off: F64


@dataclass(frozen=True)
class Noise:
    """Fields of `TrackerConfig` as the truth has them."""

    logit_half: float
    logit_slope: float
    doubt_noise: float
    given_std: tuple[float, float]
    yaw_std: float


def residuals(played: Sequence[Drive]) -> Residuals:
    """Of every detection of some sequences, matched to the truth by 3-D overlap in each scan."""
    score, real, off = [], [], []
    for drive in played:
        for truth, found in zip(drive.truth, drive.detections, strict=True):
            overlap = iou_3d(truth, found)
            i, j = linear_sum_assignment(-overlap)
            kept = overlap[i, j] >= LEAST_OVERLAP
            i, j = i[kept], j[kept]
            rows = np.full((len(found), 3), np.nan)
            c, s = np.cos(truth.yaw[i]), np.sin(truth.yaw[i])
            gap = found.center[j] - truth.center[i]
            rows[j, 0], rows[j, 1] = c * gap[:, 0] + s * gap[:, 1], c * gap[:, 1] - s * gap[:, 0]
            rows[j, 2] = half_turn(found.yaw[j] - truth.yaw[i])
            score.append(found.score.astype(float))
            real.append(np.isfinite(rows[:, 0]))
            off.append(rows)
    return Residuals(np.concatenate(score), np.concatenate(real), np.concatenate(off))


def fit_noise(found: Residuals) -> Noise:
    """The logistic law of being real by score, and deviations by that probability.

    Deviations are robust (median absolute), as matches of another object are among them: first by
    class of score, then sigma (1 + doubt sqrt(1 - trust)) through the classes.

    Raises:
        ConfigError: too few detections are matched, or none is not.
    """
    if found.real.sum() < LEAST or found.real.all():
        raise ConfigError(
            f"{int(found.real.sum())} of {len(found.real)} detections are matched to a label; a fit takes "
            f"{LEAST} and some that are not; give more sequences"
        )
    slope, half = _logistic(found.score, found.real)
    trust = 1 / (1 + np.exp(-slope * (found.score - half)))[found.real]
    doubt, off = np.sqrt(1 - trust), found.off[found.real]
    parts = np.array_split(np.argsort(doubt), CLASSES)
    level = np.array([doubt[p].mean() for p in parts])
    std = np.array([MAD * np.median(np.abs(off[p] - np.median(off[p], axis=0)), axis=0) for p in parts])
    lines = [np.polyfit(level, std[:, k], 1) for k in range(3)]  # sigma, sigma doubt
    factor = float(np.median([max(rise, 0) / max(base, 1e-3) for rise, base in lines]))
    base = [float(np.mean(std[:, k] / (1 + factor * level))) for k in range(3)]
    return Noise(float(half), float(slope), factor, (base[0], base[1]), base[2])


def noise_table(played: Sequence[Drive]) -> Rows:
    """The fit to some sequences beside what the configuration has."""
    noise, config = fit_noise(residuals(played)), TrackerConfig()
    names = [f.name for f in fields(Noise)]
    rows = [(name, _say(getattr(noise, name)), _say(getattr(config, name))) for name in names]
    return Rows("noise", ("TrackerConfig", "from truth", "as it is"), tuple(rows), left=1)


def _logistic(score: F64, real: Bool) -> tuple[float, float]:
    """Slope and middle of the most likely logistic law."""

    def loss(p: F64) -> float:
        z = p[0] * (score - p[1])
        return float(np.mean(np.logaddexp(0, z) - real * z))

    slope, half = minimize(loss, np.array([1.0, float(np.median(score))]), method="Nelder-Mead").x
    return float(slope), float(half)


def _say(value: float | tuple[float, float]) -> str:
    return ", ".join(f"{v:.3f}" for v in np.atleast_1d(value))
