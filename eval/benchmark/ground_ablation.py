"""What each idea of a ground method brings: the method with that idea switched off, in turn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from eval.benchmark.ground_grid import Row, mean_figure, methods_of
from eval.benchmark.ground_methods import Contestant, ours

ABLATIONS: Mapping[str, Mapping[str, Any]] = {
    "coarse sheet": {"coarse": False},
    "a sheet that bends": {"coarse_bend": 0.15},
    "asymmetric weights": {"asymmetric": False},
    "reject obstacle cells": {"reject": False},
    "connectivity": {"connect": False},
    "refit": {"refit": False},
    "foot rule": {"foot_factor": 1.0},
    "limits far from feet": {"point_height": 0.12, "foot_factor": 0.46},
    "roughness in the limits": {"point_noise": 0.0},
    "threshold by slope": {"point_slope": 0.0},
    "threshold by range": {"point_range": 0.0},
}
"""Fields of `GroundConfig` that switch one idea off."""
SHOWN = ("f1", "leak", "obstacle_precision", "height_rmse", "ratio")
Cost = tuple[str, dict[str, float | None]]


def contestants(method: str) -> list[Contestant]:
    """The method as it is, then without each idea."""
    return [ours(method), *(ours(method, off, f"without {name}") for name, off in ABLATIONS.items())]


def costs(rows: Sequence[Row]) -> list[Cost]:
    """Means over the scenes: of the whole method, then how far each figure moves without each idea.

    A negative change of f1, or a positive one of leak, is what the idea is worth.
    """
    split = {m: [row for row in rows if row.method == m] for m in methods_of(rows)}
    (whole, own), *others = [
        (m, {name: mean_figure(part, name) for name in SHOWN}) for m, part in split.items()
    ]
    return [(whole, own), *((m, {k: _change(v, own[k]) for k, v in got.items()}) for m, got in others)]


def _change(value: float | None, own: float | None) -> float | None:
    return None if value is None or own is None else value - own
