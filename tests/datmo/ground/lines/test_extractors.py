"""What all six line extractors promise."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.errors import ConfigError, MessageError
from datmo.ground.lines import (
    COUNT,
    END,
    EXTRACTORS,
    GROUND,
    INTERCEPT,
    RMSE,
    SLOPE,
    START,
    LineMethod,
    LineRules,
    extract_lines,
)

NAMES: tuple[Any, ...] = tuple(EXTRACTORS)
SEARCHING = ("hough", "em", "ransac")
KNOTS, HEIGHTS = [2.0, 12.0, 22.0, 34.0, 46.0, 60.0], [-1.7, -1.7, 0.3, -0.9, 0.3, -2.5]
EXACT = LineRules(join=0.004, rmse=0.002, turn=0.002)
every = pytest.mark.parametrize("name", NAMES)


def uneven(n: int, seed: int) -> np.ndarray:
    return np.sort(np.random.default_rng(seed).uniform(2, 60, n))


def test_the_names_are_those_of_the_type() -> None:
    assert set(NAMES) == set(get_args(LineMethod))


@every
@pytest.mark.parametrize("seed", range(4))
def test_breaks_and_slopes_of_a_noiseless_profile(name: Any, seed: int) -> None:
    r = uneven(110, seed)
    lines = extract_lines(r, np.interp(r, KNOTS, HEIGHTS), EXACT, name)
    lines = lines[lines[:, COUNT] > 4]
    slopes = np.diff(HEIGHTS) / np.diff(KNOTS)
    assert lines[:, SLOPE] == pytest.approx(slopes, abs=2e-3)
    assert lines[:, INTERCEPT] == pytest.approx(HEIGHTS[:-1] - slopes * KNOTS[:-1], abs=0.08)
    last = np.searchsorted(r, KNOTS[1:]) - 1
    found = np.searchsorted(r, lines[:, END])
    assert np.abs(found - last).max() <= 1  # the break lies between two points
    assert np.abs(np.searchsorted(r, lines[1:, START]) - last[:-1] - 1).max() <= 1


@every
def test_a_line_is_the_total_least_squares_of_its_points(name: Any) -> None:
    r = uneven(80, 5)
    z = 0.25 * r - 9 + np.random.default_rng(3).normal(0, 0.02, 80)
    lines = extract_lines(r, z, LineRules(join=1.0, turn=10.0, rmse=1.0), name)
    assert len(lines) == 1
    assert lines[0, COUNT] == 80
    middle = np.array([r.mean(), z.mean()])
    _, values, axes = np.linalg.svd(np.column_stack([r, z]) - middle, full_matrices=False)
    slope = axes[0, 1] / axes[0, 0]
    assert lines[0, SLOPE] == pytest.approx(slope, rel=1e-9)
    assert lines[0, INTERCEPT] == pytest.approx(middle[1] - slope * middle[0], rel=1e-9)
    assert lines[0, RMSE] == pytest.approx(values[1] / np.sqrt(80), rel=1e-6)


@every
def test_ground_is_neither_steep_nor_a_plateau(name: Any) -> None:
    r = np.arange(2, 40, 0.4)
    z = np.interp(r, [0, 12, 22, 26, 40], [0, 0, 2, 10, 10])
    lines = extract_lines(r, z, LineRules(join=0.03, rmse=0.02), name)
    lines = lines[lines[:, COUNT] > 4]
    assert lines[:, SLOPE] == pytest.approx([0, 0.2, 2, 0], abs=0.01)
    assert lines[:, GROUND].tolist() == [1, 1, 0, 0]


@every
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_the_contract_of_any_profile(name: Any, data: st.DataObject) -> None:
    """Finite, by start, no point twice; with ties, steps, walls and heights of a million."""
    n = data.draw(st.integers(0, 40))
    steps = st.sampled_from([0.0, 0.0, 0.01, 0.4, 3.0])
    r = 2 + np.cumsum(data.draw(st.lists(steps, min_size=n, max_size=n)))
    heights = st.sampled_from([0.0, 0.02, -0.3, 1.5, 1e6, -1e6])
    z = np.array(data.draw(st.lists(heights, min_size=n, max_size=n)), float)
    lines = extract_lines(r, z, method=name)
    assert lines.shape == (len(lines), 7)
    assert np.isfinite(lines).all()
    assert (np.diff(lines[:, START]) >= 0).all()
    assert (lines[:, START] <= lines[:, END]).all()
    assert (lines[:, COUNT] >= 2).all()
    assert lines[:, COUNT].sum() <= n
    assert set(lines[:, GROUND]) <= {0.0, 1.0}


@every
@pytest.mark.parametrize("n", [0, 1])
def test_fewer_than_two_points_make_no_line(name: Any, n: int) -> None:
    assert extract_lines(np.ones(n), np.ones(n), method=name).shape == (0, 7)


@every
@pytest.mark.parametrize("n", [2, 3, 4, 7, 60])
def test_one_line_is_found_whole(name: Any, n: int) -> None:
    r = np.linspace(3, 50, n)
    lines = extract_lines(r, 0.12 * r - 3, method=name)
    if n < 4 and name in SEARCHING:
        assert len(lines) == 0
        return
    assert lines[:, COUNT].tolist() == [n]
    assert lines[0, SLOPE] == pytest.approx(0.12, abs=1e-9)
    assert lines[0, [START, END]].tolist() == [3, 50]


@every
def test_equal_points_are_one_level_line(name: Any) -> None:
    lines = extract_lines(np.full(9, 4.0), np.full(9, 0.3), method=name)
    assert lines.tolist() == [[4, 4, 0, pytest.approx(0.3), 0, 9, 1]]


@every
def test_a_vertical_wall_is_no_ground(name: Any) -> None:
    r = np.concatenate([np.arange(2, 10, 0.4), np.full(20, 10.0)])
    z = np.concatenate([np.zeros(20), np.linspace(0.5, 6, 20)])
    lines = extract_lines(r, z, method=name)
    lines = lines[lines[:, COUNT] > 4]
    assert lines[:, COUNT].tolist() == [20, 20]
    assert lines[:, GROUND].tolist() == [1, 0]
    assert abs(lines[1, SLOPE]) > 100
    assert np.isfinite(lines).all()


@pytest.mark.parametrize("name", SEARCHING)
def test_searching_ones_look_through_an_obstacle(name: Any) -> None:
    r = np.linspace(3, 40, 70)
    z = 0.05 * r - 1.7
    z[30:33] += 0.8
    lines = extract_lines(r, z, method=name)
    assert lines[0, COUNT] == 67
    assert lines[0, [START, END]].tolist() == [3, 40]


@every
def test_the_same_again_and_chance_only_from_the_generator(name: Any) -> None:
    r = uneven(100, 7)
    z = np.interp(r, KNOTS, HEIGHTS) + np.random.default_rng(2).normal(0, 0.05, 100)
    rules = LineRules(join=0.06)
    first = extract_lines(r, z, rules, name, np.random.default_rng(1))
    assert np.array_equal(first, extract_lines(r, z, rules, name, np.random.default_rng(1)))
    assert np.array_equal(extract_lines(r, z, rules, name), extract_lines(r, z, rules, name))
    others = [extract_lines(r, z, rules, name, np.random.default_rng(k)) for k in range(2, 12)]
    differs = any(not np.array_equal(first, other) for other in others)
    assert differs == (name in ("em", "ransac"))


@every
@pytest.mark.parametrize(
    ("r", "z"),
    [
        ([1.0, np.nan], [0.0, 0.0]),
        ([1.0, 2.0], [0.0, np.inf]),
        ([2.0, 1.0], [0.0, 0.0]),
        ([1.0, 2.0], [0.0]),
        ([[1.0]], [[0.0]]),
    ],
)
def test_what_is_no_profile_is_refused(name: Any, r: list[Any], z: list[Any]) -> None:
    with pytest.raises(MessageError, match="must"):
        extract_lines(np.array(r), np.array(z), method=name)


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(ConfigError, match="ransac"):
        extract_lines(np.ones(3), np.ones(3), method="ransack")  # type: ignore[arg-type]
