from __future__ import annotations

import numpy as np
import pytest

from datmo.ground import METHODS, segment_ground

RNG = np.random.default_rng(0)
FLAT = np.column_stack([RNG.uniform(-40, 40, (4000, 2)), RNG.normal(-1.7, 0.01, 4000)])
CLOUDS = {
    "empty": np.zeros((0, 3)),
    "one point": np.array([[5.0, 1.0, -1.7]]),
    "at the origin": np.zeros((10, 3)),
    "all equal": np.full((100, 3), 3.0),
    "all NaN": np.full((10, 3), np.nan),
    "infinite": np.full((10, 3), np.inf),
    "one segment": np.column_stack([np.linspace(3, 60, 200), np.full(200, 0.1), np.full(200, -1.7)]),
    "no ground": np.column_stack(
        [
            10 * np.cos(RNG.uniform(0, 6.28, 500)),
            10 * np.sin(RNG.uniform(0, 6.28, 500)),
            RNG.uniform(0, 3, 500),
        ]
    ),
    "a wall in front": np.column_stack(
        [np.full(500, 8.0), RNG.uniform(-6, 6, 500), RNG.uniform(-0.5, 2, 500)]
    ),
    "huge heights": np.column_stack([FLAT[:, :2], RNG.choice([-1e6, 1e6], 4000)]),
    "beyond float32": FLAT * 1e300,
    "all beyond": FLAT + np.array([1000, 0, 0]),
    "flat": FLAT,
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", list(CLOUDS))
def test_any_cloud_has_an_answer(name: str, method: str) -> None:
    points = CLOUDS[name]
    ground = segment_ground(points, method)
    assert len(ground) == len(points)
    finite = (np.abs(points[:, :2]) < 1e38).all(1)
    assert np.array_equal(np.isfinite(ground.height), finite)
    assert np.array_equal(np.isfinite(ground.height_std), finite)
    assert (ground.height_std[finite] > 0).all()
    mean, std = ground.surface(RNG.uniform(-90, 90, (50, 2)))
    assert np.isfinite(mean).all()
    assert (std > 0).all()


def test_without_points_the_surface_is_level_and_unsure() -> None:
    mean, std = segment_ground(np.zeros((0, 3))).surface(np.array([[0.0, 0.0], [30.0, -5.0]]))
    assert np.allclose(mean, -1.73)
    assert (std >= 1.0).all()


def test_flat_ground_is_ground_whatever_else_is_there() -> None:
    stray = np.array(
        [[np.nan] * 3, [10, 0, np.inf], [10, 0, 1e6], [12, 3, -1e6], [np.inf, 0, 0], [0, 0, 0], [11, 0, -9]]
    )
    ground = segment_ground(np.concatenate([FLAT, stray]))
    inside = np.hypot(*FLAT[:, :2].T) > 2.0
    assert ground.is_ground[: len(FLAT)][inside].mean() > 0.999
    assert not ground.is_ground[len(FLAT) :].any()
    assert np.abs(ground.height[: len(FLAT)] + 1.7).max() < 0.05
