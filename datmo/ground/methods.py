"""The ground methods by name."""

from __future__ import annotations

from collections.abc import Callable

from datmo.ground.config import GroundConfig
from datmo.ground.field import Field
from datmo.ground.grid import PolarGrid
from datmo.ground.regression import Regression
from datmo.ground.z import LineLengths, OneLength
from datmo.ground.zl import LatentLengths, LatentLengthsAndNoise

REGRESSIONS: dict[str, Callable[[PolarGrid, GroundConfig], Regression]] = {
    "default": Field,
    "z": LineLengths,
    "z-se": OneLength,
    "zl": LatentLengths,
    "zli": LatentLengthsAndNoise,
}
METHODS: tuple[str, ...] = tuple(REGRESSIONS)


def regression(grid: PolarGrid, config: GroundConfig) -> Regression:
    """The regression that the config names."""
    return REGRESSIONS[config.method](grid, config)
