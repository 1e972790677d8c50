"""The rule filter of Table 5.2: boxes that no road user shows are refused, with the reason."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, I64, Bool
from datmo.boxes.config import FilterConfig


@dataclass(frozen=True)
class Rejection:
    """Why a cluster gave no box.

    Attributes:
        cluster: its label.
        rule: the quantity, the first that broke its limit.
        value, limit: of that quantity.
    """

    cluster: int
    rule: str
    value: float
    limit: float

    def __str__(self) -> str:
        relation = "<" if self.value < self.limit else ">"
        return f"cluster {self.cluster}: {self.rule} {self.value:.4g} {relation} {self.limit:.4g}"


def apply_rules(
    size: F64, points: I64, clearance: F64, config: FilterConfig
) -> tuple[Bool, tuple[Rejection, ...]]:
    """Which boxes pass every rule, and for each other one the first rule that it breaks.

    Args:
        size: (k, 3) length, width, height [m]; row = cluster label.
        points: (k,) number of points of each cluster.
        clearance: (k,) height of its lowest point above the ground [m].
        config: the limits.
    """
    broken = np.zeros(len(size), np.bool_)
    rejections: list[Rejection] = []
    for rule, value, (low, high) in _rules(size, points, clearance, config):
        with np.errstate(invalid="ignore"):
            outside = ~broken & ((value < low) | (value > high))
        for k in np.flatnonzero(outside):
            limit = low if value[k] < low else high
            rejections.append(Rejection(int(k), rule, float(value[k]), float(limit)))
        broken |= outside
    return ~broken, tuple(sorted(rejections, key=lambda r: r.cluster))


def _rules(
    size: F64, points: I64, clearance: F64, config: FilterConfig
) -> tuple[tuple[str, F64, tuple[float, float]], ...]:
    """Name, value (k,) and limits of each rule, in the order of checking; NaN is not checked."""
    length, width, height = size.T
    area = length * width
    volume = area * height
    long = length >= config.ratio_above
    slender = length < config.slender_length
    ratio = np.where(long, length / np.maximum(width, 1e-6), np.nan)
    density = np.where(volume > 0, points / np.maximum(volume, 1e-9), np.inf)
    return (
        ("points", points.astype(float), (config.points, np.inf)),
        ("length", length, config.length),
        ("width", width, config.width),
        ("height", height, config.height),
        ("volume", volume, config.volume),
        ("area", area, config.area),
        ("ratio", ratio, config.ratio),
        ("slender height", np.where(slender, height, np.nan), (0.0, config.slender_height)),
        ("clearance", clearance, (-np.inf, config.clearance)),
        ("density", density, (config.density, np.inf)),
    )
