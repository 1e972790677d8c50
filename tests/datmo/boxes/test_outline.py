"""The outline: nearest point in each direction; its shape."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.boxes.outline import outlines
from datmo.boxes.rectangle import extents
from datmo.boxes.shape import Shape, _on_sides, shapes


def outline_plainly(points, sensor, most, step):
    """Bins of azimuth about the middle of the cluster, the nearest point of each."""
    middle = (points.min(0) + points.max(0)) / 2 - sensor
    turn = np.angle((points - sensor) @ [1, 1j] * np.conj(middle @ [1, 1j]))
    width = max(step, np.ptp(turn) / most)
    bins = np.minimum(((turn - turn.min()) / width).astype(int), most - 1)
    rows = [np.flatnonzero(bins == b) for b in range(most)]
    return np.array(
        [points[r[np.argmin(np.linalg.norm(points[r] - sensor, axis=1))]] for r in rows if len(r)]
    )


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 80), st.floats(-np.pi, np.pi))
def test_outline_is_the_nearest_point_of_each_bin(seed, n, azimuth):
    rng = np.random.default_rng(seed)
    sensor = np.array([100.0, -40.0])
    points = sensor + 9 * np.array([np.cos(azimuth), np.sin(azimuth)]) + rng.normal(size=(n, 2))
    outline, length = outlines(points, np.array([0, n]), sensor, 16, 0.01)
    expected = outline_plainly(points, sensor, 16, 0.01)
    np.testing.assert_array_equal(outline[0, : length[0]], expected)
    again, _ = outlines(points[rng.permutation(n)], np.array([0, n]), sensor, 16, 0.01)
    np.testing.assert_array_equal(again, outline)


def test_equal_points_and_the_sensor_itself():
    points = np.concatenate([np.full((9, 2), 3.0), np.zeros((2, 2)), [[1.0, 0], [-1, 0], [0, 1], [0, -1]]])
    outline, length = outlines(points, np.array([0, 9, 9, 11, 15]), np.zeros(2), 8, 0.01)
    assert length.tolist() == [1, 0, 1, 4]
    assert outline[0, 0].tolist() == [3, 3]


def side(a, b, n=20):
    return np.linspace(a, b, n)


FRONT, LEFT, RIGHT = side([2, -1], [2, 1]), side([-2, 1], [2, 1]), side([-2, -1], [2, -1])
SHAPES = {
    Shape.NONE: np.zeros((1, 2)),
    Shape.I: LEFT,
    Shape.L: np.concatenate([FRONT, LEFT]),
    Shape.U: np.concatenate([FRONT, LEFT, RIGHT]),
    Shape.V: np.concatenate([side([-2, -1], [0, 0]), side([0, 0], [2, -1])]),
}


@pytest.mark.parametrize("shape", list(SHAPES))
@pytest.mark.parametrize("angle", [0.0, 0.5, 1.3])
def test_shapes_are_told_apart(shape, angle):
    points = SHAPES[shape]
    c, s = np.cos(angle), np.sin(angle)
    points = points @ np.array([[c, s], [-s, c]])
    extent = extents(points, np.array([0, len(points)]), np.array([angle]))
    outline = np.zeros((1, 64, 2))
    outline[0, : len(points)] = points
    assert shapes(outline, np.array([len(points)]), np.array([angle]), extent, 0.1).tolist() == [shape]


def sides_plainly(outline, angle, extent, tolerance):
    """Points on each side, one point and one side at a time."""
    on = [0, 0, 0, 0]
    for x, y in outline:
        along, across = np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x
        distance = [abs(v - e) for v, e in zip([along, along, across, across], extent, strict=True)]
        if min(distance) <= tolerance:
            on[distance.index(min(distance))] += 1
    return on


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.lists(st.integers(0, 12), min_size=1, max_size=5))
def test_points_are_counted_on_their_nearest_side(seed, lengths):
    rng = np.random.default_rng(seed)
    k = len(lengths)
    outline, angle = rng.integers(-2, 3, (k, 12, 2)) / 2, rng.choice([0.0, 0.3, 1.2], k)
    extent = np.tile([-1.0, 1.0, -0.5, 0.5], (k, 1))
    on = _on_sides(outline, np.array(lengths), np.cos(angle), np.sin(angle), extent, 0.2)
    for row, points, n, a, e in zip(on, outline, lengths, angle, extent, strict=True):
        assert row.tolist() == sides_plainly(points[:n], a, e, 0.2)
