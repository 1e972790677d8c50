"""Hull against scipy; least area against a fine sweep of angles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial import ConvexHull

from datmo.boxes.hull import convex_hull, least_area_angles
from datmo.geometry import polygon_area


def area_at(points, angle):
    c, s = np.cos(angle), np.sin(angle)
    x, y = c * points[:, 0] + s * points[:, 1], c * points[:, 1] - s * points[:, 0]
    return np.ptp(x) * np.ptp(y)


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(4, 200))
def test_hull_is_scipys(seed, n):
    points = np.random.default_rng(seed).normal(size=(n, 2))
    got, expected = convex_hull(points), points[ConvexHull(points).vertices]
    start = np.lexsort(expected.T[::-1])[0]
    assert np.array_equal(got, np.roll(expected, -start, axis=0))


@settings(max_examples=200, deadline=None)
@given(arrays(np.int64, st.tuples(st.integers(1, 25), st.just(2)), elements=st.integers(-3, 3)))
def test_hull_of_a_lattice_is_strictly_convex_and_holds_all(points):
    points = points.astype(float)
    hull = convex_hull(points)
    assert {tuple(p) for p in hull} <= {tuple(p) for p in points}
    assert len({tuple(p) for p in hull}) == len(hull)
    if len(hull) < 3:  # the ends of a line, or one place
        assert np.array_equal(hull[0], points[np.lexsort(points.T[::-1])[0]])
        assert np.array_equal(hull[-1], points[np.lexsort(points.T[::-1])[-1]])
        return
    assert polygon_area(hull) > 0
    for a, b, c in zip(hull, np.roll(hull, -1, 0), np.roll(hull, -2, 0), strict=True):
        e, f = b - a, c - b
        assert e[0] * f[1] - e[1] * f[0] > 0
        assert np.all(e[0] * (points[:, 1] - a[1]) - e[1] * (points[:, 0] - a[0]) >= 0)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(3, 60))
def test_no_angle_gives_less_area(seed, n):
    points = np.random.default_rng(seed).normal(size=(n, 2)) * [3, 1]
    found = least_area_angles(points, np.array([0, n]))[0]
    swept = min(area_at(points, a) for a in np.linspace(0, np.pi / 2, 721))
    assert area_at(points, found) <= swept + 1e-9
    assert 0 <= found < np.pi / 2


def test_degenerate_clusters_have_an_angle():
    line = np.outer(np.arange(5), [np.cos(0.4), np.sin(0.4)])
    clusters = [np.zeros((0, 2)), np.ones((1, 2)), np.ones((4, 2)), line]
    starts = np.cumsum([0, *map(len, clusters)])
    angles = least_area_angles(np.concatenate(clusters), starts)
    assert np.all(angles[:3] == 0)
    np.testing.assert_allclose(angles[3], 0.4)


@pytest.mark.parametrize("tilt", [1e-17, 1e-18, 5e-324])
def test_an_edge_that_all_but_lies_along_an_axis_has_the_angle_zero(tilt):
    two, four = np.array([[0, 0], [1, -tilt]]), np.array([[0, 0], [1, -tilt], [1, 1], [0, 1]])
    assert np.all(least_area_angles(np.concatenate([two, four]), np.array([0, 2, 6])) == 0)
