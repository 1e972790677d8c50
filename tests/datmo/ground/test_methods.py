"""What holds for every method, over a sequence and in every order."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, get_args

import numpy as np
import pytest

from datmo import threads
from datmo.ground import METHODS, GroundConfig, GroundSegmenter, segment_ground
from datmo.ground.config import Method

Make = Callable[..., Any]
FEW = ("default", "zli")
every_method = pytest.mark.parametrize(
    "method", [m if m in FEW else pytest.param(m, marks=pytest.mark.long) for m in METHODS]
)


@pytest.fixture(scope="module")
def sweeps(scene: Make) -> list[np.ndarray]:
    return [scene("E", 0.1, seed=30 + k, columns=360, cars=6).points for k in range(2)]


def play(segmenter: GroundSegmenter, sweeps: list[np.ndarray]) -> list[Any]:
    return [segmenter.step(points) for points in (*sweeps, *sweeps)]


def test_every_name_has_its_regression() -> None:
    assert set(METHODS) == set(get_args(Method))


@every_method
def test_a_sequence_has_the_same_bytes_again_after_a_reset(method: str, sweeps: list[np.ndarray]) -> None:
    segmenter = GroundSegmenter(GroundConfig(method=method))
    first = play(segmenter, sweeps)
    learned = segmenter.learned
    segmenter.reset()
    assert segmenter.learned.frames == 0
    assert play(segmenter, sweeps) == first
    assert segmenter.learned.hyper == learned.hyper
    assert first[0] == segment_ground(sweeps[0], method)


@every_method
def test_a_frame_starts_where_the_last_one_ended(method: str, sweeps: list[np.ndarray]) -> None:
    segmenter, values = GroundSegmenter(GroundConfig(method=method)), []
    for _ in range(4):
        segmenter.step(sweeps[0])
        values.append(segmenter.learned.value)
    assert segmenter.learned.frames == 4
    assert segmenter.learned.evaluations <= 2 * segmenter.config.learn_next
    if method == "default":  # closed form: no objective is climbed
        assert segmenter.learned.evaluations == 0
        assert np.isnan(values).all()
    else:
        assert values[-1] > values[0] - 0.01 * abs(values[0])


@every_method
def test_what_was_learned_is_told(method: str, sweeps: list[np.ndarray]) -> None:
    segmenter = GroundSegmenter(GroundConfig(method=method))
    segmenter.step(sweeps[0])
    learned = segmenter.learned
    if method == "default":
        assert set(learned.hyper) == {"c"}
        assert 1e-4 < learned.hyper["c"] < 1e-2  # class E
    else:
        assert {"sigma_f", "sigma_n"} <= set(learned.hyper)
        assert learned.hyper["sigma_n"] >= segmenter.config.noise_floor
    assert learned.candidates.shape == learned.supports.shape == learned.lines.shape == (180,)
    assert np.median(learned.candidates) > 20
    assert (learned.supports.max() > 0) == (method in ("zl", "zli"))
    assert (learned.supports <= np.minimum(learned.candidates, segmenter.config.supports)).all()
    assert (learned.lines.max() > 0) == (method in ("z", "zl", "zli"))


@every_method
def test_threads_do_not_change_the_bytes(
    method: str, sweeps: list[np.ndarray], monkeypatch: pytest.MonkeyPatch
) -> None:
    with_threads = play(GroundSegmenter(GroundConfig(method=method)), sweeps)
    monkeypatch.setattr(threads, "workers", lambda: 1)
    monkeypatch.setattr(threads, "ROWS", 7)
    assert play(GroundSegmenter(GroundConfig(method=method)), sweeps) == with_threads


@every_method
def test_order_and_copies_do_not_matter(method: str, sweeps: list[np.ndarray]) -> None:
    points = sweeps[0]
    whole = segment_ground(points, method)
    order = np.random.default_rng(0).permutation(len(points))
    shuffled = segment_ground(points[order], method)
    assert np.array_equal(shuffled.height, whole.height[order])
    assert np.array_equal(shuffled.is_ground, whole.is_ground[order])
    twice = segment_ground(np.concatenate([points, points]), method)
    assert np.array_equal(twice.is_ground[: len(points)], whole.is_ground)
    assert np.allclose(twice.height[: len(points)], whole.height, atol=1e-5)


@pytest.mark.parametrize("method", METHODS)
def test_turning_the_cloud_turns_the_ground(method: str, sweeps: list[np.ndarray]) -> None:
    """Up to float32 without the coarse sheet, whose lines are a third of the segments."""
    points, a = sweeps[0].astype(float), np.radians(46)
    turned = np.column_stack(
        [*(np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) @ points[:, :2].T), points[:, 2]]
    )
    where = np.degrees(np.arctan2(points[:, 1], points[:, 0])) / 2
    off_edge = np.abs(where - np.round(where)) > 1e-4
    config = GroundConfig(method=method, coarse=False)
    one = segment_ground(points[off_edge], config=config)
    two = segment_ground(turned[off_edge], config=config)
    assert np.mean(one.is_ground == two.is_ground) >= 0.9999
    near = np.hypot(*points[off_edge, :2].T) < 50
    assert np.quantile(np.abs(one.height - two.height)[near], 0.99) < 1e-4


@pytest.mark.parametrize("method", ["zl", "zli"])
@pytest.mark.parametrize("objective", ["printed", "prior"])
def test_the_thesis_objectives_stay_bounded_and_say_so(
    method: str, objective: str, sweeps: list[np.ndarray]
) -> None:
    segmenter = GroundSegmenter(GroundConfig(method=method, objective=objective, learn_first=80))
    ground = segmenter.step(sweeps[0])
    assert np.isfinite(ground.height).all()
    assert any("bar_sigma" in note and "bound" in note for note in segmenter.learned.notes)
