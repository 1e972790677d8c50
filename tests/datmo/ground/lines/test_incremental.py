from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.ground.lines import COUNT, END, GROUND, INTERCEPT, RMSE, SLOPE, START, LineRules, extract_lines


def piecewise(r: np.ndarray) -> np.ndarray:
    """Flat to 10 m, rising by 20 % to 20 m, then a wall's slope of 200 % to 22 m, flat behind."""
    return np.interp(r, [0, 10, 20, 22, 40], [0, 0, 2, 6, 6])


def test_lines_of_a_known_profile() -> None:
    r = np.arange(2, 40, 0.5)
    lines = extract_lines(r, piecewise(r))
    assert np.allclose(lines[:, SLOPE], [0, 0.2, 2, 0], atol=0.03)
    assert np.allclose(lines[:, END], [10, 20, 22, 39.5], atol=0.51)
    assert lines[:, GROUND].tolist() == [1, 1, 0, 0]  # the last is a plateau
    assert np.allclose(lines[1, INTERCEPT], -2, atol=0.3)


def test_lines_share_out_the_points_in_order() -> None:
    rng = np.random.default_rng(0)
    r = np.sort(rng.uniform(2, 60, 90))
    lines = extract_lines(r, piecewise(r) + rng.normal(0, 0.01, 90))
    assert lines[:, COUNT].sum() <= 90
    assert (lines[:, START] < lines[:, END]).all()
    assert (lines[1:, START] > lines[:-1, END]).all()
    assert (lines[:, RMSE] < 0.1).all()


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.29, 0.29), st.floats(-0.4, 0.4), st.integers(2, 60))
def test_one_line_is_found_whole(slope: float, intercept: float, n: int) -> None:
    r = np.linspace(3, 50, n)
    lines = extract_lines(r, slope * r + intercept)
    assert len(lines) == 1
    assert lines[0, SLOPE] == pytest.approx(slope, abs=1e-9)
    assert lines[0, INTERCEPT] == pytest.approx(intercept, abs=1e-7)
    assert lines[0, GROUND] == 1


def test_fit_is_total_least_squares() -> None:
    rng = np.random.default_rng(3)
    r = np.linspace(2, 12, 30)
    z = 0.25 * r + rng.normal(0, 0.02, 30)
    lines = extract_lines(r, z, LineRules(turn=10.0, join=10.0))
    centred = np.column_stack([r - r.mean(), z - z.mean()])
    values, vectors = np.linalg.eigh(centred.T @ centred)
    assert len(lines) == 1
    assert lines[0, SLOPE] == pytest.approx(vectors[1, 1] / vectors[0, 1], rel=1e-9)
    assert lines[0, RMSE] == pytest.approx(np.sqrt(values[0] / 30), rel=1e-6)


@pytest.mark.parametrize("n", [0, 1])
def test_too_few_points_make_no_line(n: int) -> None:
    assert extract_lines(np.ones(n), np.ones(n)).shape == (0, 7)


def by_hand(r: np.ndarray, z: np.ndarray, rules: LineRules) -> list[list[float]]:
    """Alg. 1 as one reads it: fit with the next point by SVD; keep the line without it when it breaks."""

    def tls(a: int, b: int) -> tuple[float, float, np.ndarray]:
        points = np.column_stack([r[a:b], z[a:b]])
        middle = points.mean(0)
        _, values, axes = np.linalg.svd(points - middle, full_matrices=False)
        angle = np.arctan(axes[0, 1] / axes[0, 0])
        return angle, (values[1] if len(values) > 1 else 0.0) / np.sqrt(b - a), middle

    lines, a = [], 0
    while a < len(r) - 1:
        b = a + 2
        while b < len(r):
            angle, _, middle = tls(a, b)
            turned, rmse, _ = tls(a, b + 1)
            off = abs(np.cos(angle) * (z[b] - middle[1]) - np.sin(angle) * (r[b] - middle[0]))
            allowed = rules.turn + 2 * rules.rmse / (r[b] - r[a])
            if off > rules.join or abs(turned - angle) > allowed or rmse > rules.rmse:
                break
            b += 1
        angle, rmse, middle = tls(a, b)
        slope = np.tan(angle)
        lines.append([r[a], r[b - 1], slope, middle[1] - slope * middle[0], rmse, b - a])
        a = b
    return lines


@pytest.mark.parametrize("seed", range(8))
def test_the_same_as_by_hand(seed: int) -> None:
    rng = np.random.default_rng(seed)
    r = np.cumsum(rng.uniform(0.1, 1.2, 90))
    z = np.cumsum(rng.normal(0, 0.08, 90))
    rules = LineRules(join=0.05 + 0.02 * seed)
    found = extract_lines(r, z, rules)
    assert len(found) > 2
    np.testing.assert_allclose(found[:, :GROUND], by_hand(r, z, rules), rtol=1e-6, atol=1e-7)
