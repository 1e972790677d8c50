"""The rectangle search against its pseudo-code, and against the truth of drawn outlines."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.boxes.rectangle import extents, search

CRITERIA = ("area", "closeness", "squared_error")


def score_plainly(points, theta, criterion, nearest):
    """Zhang 2017, algorithms 2 to 5, one point at a time."""
    c1 = [x * np.cos(theta) + y * np.sin(theta) for x, y in points]
    c2 = [-x * np.sin(theta) + y * np.cos(theta) for x, y in points]
    if criterion == "area":
        return -(max(c1) - min(c1)) * (max(c2) - min(c2))
    sides = []
    for c in (c1, c2):
        high, low = [max(c) - v for v in c], [v - min(c) for v in c]
        sides.append(high if np.linalg.norm(high) < np.linalg.norm(low) else low)
    if criterion == "closeness":
        return sum(1 / max(min(a, b), nearest) for a, b in zip(*sides, strict=True))
    near1 = [a for a, b in zip(*sides, strict=True) if a < b]
    near2 = [b for a, b in zip(*sides, strict=True) if not a < b]
    return -sum(float(np.var(e)) for e in (near1, near2) if e)


def search_plainly(points, criterion, weights=(0.2, 0.5, 0.3), step=1.0, nearest=0.05):
    angles = np.deg2rad(np.arange(0, 90, step))
    if criterion != "weighted":
        return angles, np.array([score_plainly(points, t, criterion, nearest) for t in angles])
    total = np.zeros(len(angles))
    for weight, name in zip(weights, CRITERIA, strict=True):
        _, q = search_plainly(points, name, step=step, nearest=nearest)
        total += weight * (q - q.min()) / (q.max() - q.min())
    return angles, total


def best(points, criterion, weights=(0.2, 0.5, 0.3)):
    length = np.array([len(points)])
    return search(points[None], length, np.deg2rad(1.0), 0.05, criterion, weights)[0]


def ell(yaw, length=4.2, width=1.7, share=1.0, noise=0.0, seed=0, at=(15.0, -4.0)):
    """Two sides of a rectangle, evenly sampled, the corner at the origin before it is moved."""
    rng = np.random.default_rng(seed)
    a = np.column_stack([np.linspace(0, length * share, 40), np.zeros(40)])
    b = np.column_stack([np.zeros(16), np.linspace(0, width, 16)])
    points = np.concatenate([a, b]) + noise * rng.normal(size=(56, 2))
    c, s = np.cos(yaw), np.sin(yaw)
    return points @ np.array([[c, s], [-s, c]]) + at


def off(a, b):
    """Difference of two angles modulo pi/2 [rad]."""
    return abs((a - b + np.pi / 4) % (np.pi / 2) - np.pi / 4)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from([*CRITERIA, "weighted"]), st.integers(0, 2**32 - 1), st.integers(3, 40))
def test_the_search_finds_what_the_plain_loop_finds(criterion, seed, n):
    points = np.random.default_rng(seed).normal(size=(n, 2)) * [2, 1]
    angles, scores = search_plainly(points, criterion)
    k = np.argmin(np.abs(angles - best(points, criterion)))
    assert scores[k] >= scores.max() - 1e-9 * max(1, abs(scores.max()))


@settings(max_examples=60, deadline=None)
@given(st.floats(-4, 4), st.sampled_from(["closeness", "squared_error", "weighted"]), st.integers(0, 99))
def test_the_yaw_of_an_l_is_found_within_two_degrees(yaw, criterion, seed):
    points = ell(yaw, noise=0.02, seed=seed)
    assert off(best(points, criterion), yaw) <= np.deg2rad(2)


def test_area_is_found_where_there_is_no_noise():
    for yaw in np.deg2rad([0, 10, 33, 89]):
        assert off(best(ell(yaw), "area"), yaw) <= np.deg2rad(1)


def test_only_outline_rows_that_count_are_read():
    outline = np.full((2, 80, 2), np.nan)
    outline[0, :56], outline[1, :56] = ell(0.3), ell(1.1)
    found = search(outline, np.array([56, 56]), np.deg2rad(1), 0.05, "closeness", (0, 1, 0))
    np.testing.assert_array_less(off(found, np.array([0.3, 1.1])), np.deg2rad(1))


@pytest.mark.parametrize("criterion", [*CRITERIA, "weighted"])
@pytest.mark.parametrize("points", [np.zeros((0, 2)), np.ones((1, 2)), np.ones((5, 2)), np.eye(2)])
def test_degenerate_outlines_have_an_angle(criterion, points):
    assert 0 <= best(points, criterion) < np.pi / 2


def test_collinear_points_have_the_angle_of_their_line():
    for criterion in ("area", "closeness", "weighted"):
        line = np.outer(np.linspace(0, 3, 30), [np.cos(0.7), np.sin(0.7)])
        assert off(best(line, criterion), 0.7) <= np.deg2rad(0.5) + 1e-12


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.lists(st.integers(0, 9), min_size=1, max_size=6))
def test_extents_are_the_least_and_largest_projections(seed, sizes):
    rng = np.random.default_rng(seed)
    starts = np.cumsum([0, *sizes])
    xy, angle = rng.normal(size=(starts[-1], 2)), rng.uniform(0, np.pi / 2, len(sizes))
    for k, (got, a) in enumerate(zip(extents(xy, starts, angle), angle, strict=True)):
        p = xy[starts[k] : starts[k + 1]] @ np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
        expected = [p[:, 0].min(), p[:, 0].max(), p[:, 1].min(), p[:, 1].max()] if len(p) else np.zeros(4)
        np.testing.assert_allclose(got, expected, atol=1e-12)
