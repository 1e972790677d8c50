"""The ground methods by name."""

from __future__ import annotations

from collections.abc import Callable

from datmo.ground.config import GroundConfig
from datmo.ground.field import Field
from datmo.ground.grid import PolarGrid
from datmo.ground.process import LineLengths, OneLength
from datmo.ground.regression import Regression

REGRESSIONS: dict[str, Callable[[PolarGrid, GroundConfig], Regression]] = {
    "default": Field,
    "z": LineLengths,
    "z-se": OneLength,
}
METHODS: tuple[str, ...] = tuple(REGRESSIONS)


def regression(grid: PolarGrid, config: GroundConfig) -> Regression:
    """The regression that the config names."""
    return REGRESSIONS[config.method](grid, config)
