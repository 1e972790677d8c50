"""Height of the ground at the centres of a fixed grid, where it was seen and where it was not."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from datmo.arrays import F32, F64, U8, Bool
from datmo.bins import BINS, SEGMENTS
from datmo.messages import Frame, Kind, Relief, Truth
from eval.metrics.ground import BAND_NAMES, RADIUS, band_of, cell_of
from eval.metrics.matching import finite
from eval.metrics.ratio import mean, ratio, root, spread

MISSING_ERROR = 1.0
LEAST_STD = 1e-6
LEAST_VARIANCE = 1e-4
SIGMAS_95 = 1.96


@dataclass(frozen=True)
class Heights:
    """Prediction and truth at g places.

    Attributes:
        true: (g,) [m, sensor]. mean, std: (g,) [m], NaN where the surface gives no prediction.
        band: (g,) range band. kind: (g,) terrain class. seen: (g,) a ground return lies in the cell.
    """

    true: F32
    mean: F32
    std: F32
    band: U8
    kind: U8
    seen: Bool

    @property
    def predicted(self) -> Bool:
        """(g,) whether there is a prediction."""
        return np.isfinite(self.mean)

    @property
    def error(self) -> F64:
        """(g,) predicted minus true [m]; 1 m where there is no prediction."""
        difference = self.mean.astype(float) - self.true
        return np.where(self.predicted, difference, MISSING_ERROR)

    def pick(self, rows: Bool) -> Heights:
        """The places of a mask (g,)."""
        return Heights(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})


def heights(frame: Frame, truth: Truth, relief: Relief, blind_radius: float) -> Heights:
    """The places of one scan that count: seen ones, and unseen ones that terrain alone would show.

    Args:
        blind_radius: [m]; unseen places nearer than this do not count.
    """
    r = np.hypot(relief.xy[:, 0], relief.xy[:, 1])
    points = frame.scan.points
    hit = cell_of(points[truth.is_ground & finite(points), :2])
    holds = np.zeros(SEGMENTS * BINS + 1, bool)
    holds[hit] = True
    holds[-1] = False  # the place of returns outside the grid
    seen = holds[cell_of(relief.xy)]
    known = np.isfinite(relief.height) & (r <= RADIUS)
    rows = np.flatnonzero(known & (seen | (relief.exposed & (r >= blind_radius))))
    mu, std = frame.ground.surface(relief.xy[rows])
    return Heights(
        true=relief.height[rows].astype(np.float32),
        mean=np.asarray(mu, np.float32),
        std=np.asarray(std, np.float32),
        band=band_of(r[rows]).astype(np.uint8),
        kind=relief.kind[rows],
        seen=seen[rows],
    )


def join(parts: list[Heights]) -> Heights:
    """Many scans as one."""
    if not parts:
        none, zero = np.zeros(0, np.float32), np.zeros(0, np.uint8)
        return Heights(none, none, none, zero, zero, np.zeros(0, bool))
    return Heights(**{f.name: np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Heights)})


def rmse(places: Heights) -> float | None:
    """Root mean squared height error [m]."""
    return root(mean(places.error**2))


def probabilistic(places: Heights) -> dict[str, float | None]:
    """smse, nlpd and coverage95 of the latent height, and the mean std beside them [m].

    smse: mean squared error / variance of the true height, None where that is below 1e-4 m².
    nlpd: -mean log N(true | mean, std²). Where there is no prediction the error is 1 m at a std
    of 1 m in nlpd, and the truth is not covered. A std below 1e-6 m counts as that.
    """
    if not len(places.true):
        return dict.fromkeys(("smse", "nlpd", "coverage95", "mean_std"))
    predicted, error = places.predicted & np.isfinite(places.std), places.error
    std = np.where(predicted, np.maximum(places.std.astype(float), LEAST_STD), MISSING_ERROR)
    error = np.where(predicted, error, MISSING_ERROR)
    variance = float(places.true.astype(float).var())
    log_density = -0.5 * np.log(2 * np.pi) - np.log(std) - 0.5 * (error / std) ** 2
    return {
        "smse": ratio(float(np.mean(places.error**2)), variance) if variance >= LEAST_VARIANCE else None,
        "nlpd": float(-log_density.mean()),
        "coverage95": float(np.mean(predicted & (np.abs(error) <= SIGMAS_95 * std))),
        "mean_std": mean(std[predicted]),
    }


def height_scores(places: Heights) -> dict[str, float | None]:
    """The named scores of the ground's height."""
    seen = places.pick(places.seen)
    beside = probabilistic(seen)
    return {
        "ground.height_rmse": rmse(seen),
        "ground.height_rmse_unseen": rmse(places.pick(~places.seen)),
        "ground.smse": beside["smse"],
        "ground.nlpd": beside["nlpd"],
        "ground.coverage95": beside["coverage95"],
    }


def height_detail(places: Heights) -> dict[str, Any]:
    """What stands beside: shares without prediction, by range band and terrain class, unseen apart."""
    detail: dict[str, Any] = {}
    for name, rows in (("seen", places.seen), ("unseen", ~places.seen)):
        part = places.pick(rows)
        by_range = {b: rmse(part.pick(part.band == i)) for i, b in enumerate(BAND_NAMES)}
        kinds = [int(k) for k in np.unique(part.kind)]
        detail[name] = {
            **probabilistic(part),
            "absolute_error": spread(np.abs(part.error)),
            "missing_share": mean(~part.predicted),
            "rmse_by_range": by_range,
            "rmse_by_terrain": {Kind(k).name.lower(): rmse(part.pick(part.kind == k)) for k in kinds},
        }
    return detail
