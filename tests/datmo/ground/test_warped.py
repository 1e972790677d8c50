"""Ground that no plane and no wide sheet follows, and a car that hides all behind it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from datmo.ground import METHODS, segment_ground

Make, Judge = Callable[..., Any], Callable[..., tuple[float, float]]
FEW = ("default", "zli")
every_method = pytest.mark.parametrize(
    "method", [m if m in FEW else pytest.param(m, marks=pytest.mark.long) for m in METHODS]
)


def warped(points: np.ndarray, height: float, wave: float) -> np.ndarray:
    """The sweep with all in it lifted by a wave along x [m]."""
    return points + height * np.sin(2 * np.pi * points[:, :1].astype(float) / wave) * [0.0, 0.0, 1.0]


def tilted(points: np.ndarray, degrees: float, axis: str) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    R = [[1, 0, 0], [0, c, -s], [0, s, c]] if axis == "x" else [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    return np.asarray(points.astype(float) @ np.array(R).T)


@pytest.fixture(scope="module")
def sweeps(scene: Make) -> dict[str, Any]:
    return {c: scene(c, 0.02, seed=50) for c in ("C", "E")}


@pytest.mark.parametrize("roughness", ["C", "E"])
@pytest.mark.parametrize(("height", "wave"), [(1.0, 15.0), (0.6, 20.0)])
def test_default_follows_short_waves(
    sweeps: dict[str, Any], judge: Judge, roughness: str, height: float, wave: float
) -> None:
    sweep = sweeps[roughness]
    f1, leak = judge(sweep, segment_ground(warped(sweep.points, height, wave), "default").is_ground)
    assert f1 >= 0.97
    assert leak <= 0.05


@every_method
@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_tilt_of_15_degrees_is_nothing(
    sweeps: dict[str, Any], judge: Judge, axis: str, method: str
) -> None:
    sweep = sweeps["E"]
    f1, leak = judge(sweep, segment_ground(tilted(sweep.points, 15.0, axis), method).is_ground)
    assert f1 >= 0.97
    assert leak <= 0.05


@every_method
@pytest.mark.parametrize("roughness", ["flat", "E"])
def test_a_car_with_nothing_behind_it_does_not_lift_the_ground(
    scene: Make, roughness: str, method: str
) -> None:
    sweep = scene(roughness, seed=52, cars=4, people=0, walls=0, beside=True)
    beside, wall = sweep.object == 99, sweep.object == 100
    ground = segment_ground(sweep.points, method)
    assert beside.sum() > 3000
    assert wall.sum() > 1000
    assert ground.is_ground[beside].mean() <= 0.02
    assert ground.is_ground[wall].mean() <= 0.02
    under = np.column_stack([np.linspace(-1.8, 1.8, 10), np.full(10, 3.9)])
    assert np.abs(ground.surface(under)[0] - sweep.true_height(under)).max() < 0.25
