from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon

from datmo.geometry import (
    corners_bev,
    inverse,
    iou_bev,
    overlap_bev,
    polygon_area,
    rotation_z,
    transform,
    wrap_angle,
)

finite = st.floats(-50, 50)
extent = st.floats(0.1, 10)


def rectangle(x: float, y: float, length: float, width: float, yaw: float) -> np.ndarray:
    return corners_bev(np.array([[x, y, 0]]), np.array([[length, width, 1]]), np.array([yaw]))[0]


@given(st.floats(-1e4, 1e4))
def test_wrapping_keeps_the_direction(angle: float) -> None:
    wrapped = float(wrap_angle(angle))
    assert -np.pi <= wrapped < np.pi
    np.testing.assert_allclose([np.cos(wrapped), np.sin(wrapped)], [np.cos(angle), np.sin(angle)], atol=1e-9)


@given(finite, finite, finite, st.floats(-4, 4))
def test_a_transform_and_its_inverse_cancel(x: float, y: float, z: float, yaw: float) -> None:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation_z(yaw), [x, y, z]
    points = np.array([[1.0, 2.0, 3.0], [-4.0, 5.0, 6.0]])
    np.testing.assert_allclose(transform(inverse(T), transform(T, points)), points, atol=1e-9)
    np.testing.assert_allclose(T @ inverse(T), np.eye(4), atol=1e-12)


@settings(max_examples=100, deadline=None)
@given(st.tuples(st.floats(-5, 5), st.floats(-5, 5), extent, extent, st.floats(-4, 4)))
def test_overlap_equals_shapely(box: tuple[float, float, float, float, float]) -> None:
    a, b = rectangle(0, 0, 4, 2, 0.3), rectangle(*box)
    expected = Polygon(a).intersection(Polygon(b)).area
    assert overlap_bev(a, b) == pytest.approx(expected, abs=1e-9)
    assert iou_bev(a, b) == pytest.approx(expected / Polygon(a).union(Polygon(b)).area, abs=1e-9)


def test_corners_run_counter_clockwise_from_front_left() -> None:
    corners = rectangle(1, 2, 4, 2, np.pi / 2)
    np.testing.assert_allclose(corners[0], [0, 4], atol=1e-12)
    assert polygon_area(corners) == pytest.approx(8)
