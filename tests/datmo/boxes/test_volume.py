"""Boxes of least volume against closed forms, against trimesh's, and on clusters without volume."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from datmo.boxes.volume import heading_of, least_volume_boxes

CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
seeds = st.integers(0, 2**32 - 1)


def box(points):
    rotation, center, size = least_volume_boxes(points, np.array([0, len(points)]))
    return rotation[0], center[0], size[0]


def cloud(seed, n):
    """Points in a lump or on an egg-shaped skin, turned, some metres away."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(n, 3))
    if seed % 2:
        points /= np.linalg.norm(points, axis=1, keepdims=True)
    return points * [2.0, 1.0, 0.7] @ turned(seed).T + rng.uniform(-50, 50, 3)


def turned(seed):
    return Rotation.random(random_state=seed).as_matrix()


def check_holds(points, rotation, center, size):
    np.testing.assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) > 0
    assert size[0] >= size[1] >= size[2] >= 0
    local = (points - center) @ rotation
    span = np.column_stack([local.min(0), local.max(0)])
    scale = 1e-8 * max(1.0, np.abs(points).max())
    np.testing.assert_allclose(span, size[:, None] / 2 * [-1, 1], atol=scale)


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(4, 60))
def test_it_holds_all_in_no_more_than_trimeshs_box(seed, n):
    points = cloud(seed, n)
    rotation, center, size = box(points)
    check_holds(points, rotation, center, size)
    assert np.prod(size) <= 1.01 * np.prod(trimesh.bounds.oriented_bounds(points)[1])


@settings(max_examples=40, deadline=None)
@given(seeds, st.tuples(*[st.floats(0.2, 6.0)] * 3), st.integers(0, 40))
def test_a_turned_cuboid_is_recovered(seed, sides, inside):
    rng = np.random.default_rng(seed)
    rotation, center = turned(seed), rng.uniform(-50, 50, 3)
    local = np.concatenate([CORNERS, rng.uniform(-0.5, 0.5, (inside, 3))]) * sides
    found, middle, size = box(local @ rotation.T + center)
    np.testing.assert_allclose(middle, center, atol=1e-6)
    np.testing.assert_allclose(size, np.sort(sides)[::-1], atol=1e-6)
    aligned = np.abs(found.T @ rotation)  # a permutation, whatever the signs; not where two sides are equal
    if np.diff(np.sort(sides)).min() > 1e-3:
        np.testing.assert_allclose(np.sort(aligned, 1), [[0, 0, 1]] * 3, atol=1e-6)


def test_a_tetrahedron_lies_in_the_cube_whose_diagonals_are_its_edges():
    four = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1.0]]) @ turned(3).T
    np.testing.assert_allclose(box(four)[2], 2)  # flush with a face it would take twice the volume


@settings(max_examples=30, deadline=None)
@given(seeds, st.integers(1, 40))
def test_the_order_of_points_does_not_matter(seed, n):
    points = cloud(seed, n)
    again = points[np.random.default_rng(seed).permutation(n)]
    for a, b in zip(box(points), box(again), strict=True):
        assert np.array_equal(a, b)


@settings(max_examples=30, deadline=None)
@given(seeds, st.integers(4, 40))
def test_turning_the_cloud_changes_no_volume(seed, n):
    points, R = cloud(seed, n), turned(seed ^ 1)
    volume = np.prod(box(points)[2])  # which box it is may change: those around a triangle are all equal
    assert np.prod(box(points @ R.T)[2]) == pytest.approx(volume, rel=1e-9)


@pytest.mark.parametrize(
    ("points", "sides"),
    [
        (np.array([[3.0, -2, 1]]), (0, 0, 0)),
        (np.full((6, 3), 7.3), (0, 0, 0)),
        (np.zeros((3, 3)), (0, 0, 0)),
        (np.array([[0.0, 0, 0], [2, 3, 6]]), (7, 0, 0)),
        (np.outer(np.linspace(0, 1, 9), [2.0, 3, 6]) + 40, (7, 0, 0)),
        (np.outer(np.linspace(0, 1, 9), [0, 0, 2.0]) - 40, (2, 0, 0)),
        (CORNERS[:4] * [1, 3, 2] @ turned(5).T + 20, (3, 2, 0)),
        (CORNERS[:3] * [1, 3, 2], (3, 2, 0)),
        (np.repeat(CORNERS, 3, axis=0) * [1, 3, 2], (3, 2, 1)),
    ],
)
def test_clusters_without_volume_have_boxes_of_no_thickness(points, sides):
    rotation, center, size = box(points)
    check_holds(points, rotation, center, size)
    np.testing.assert_allclose(size, sides, atol=1e-9)
    assert np.array_equal(size == 0, np.array(sides) == 0)


@settings(max_examples=150, deadline=None)
@given(arrays(np.int64, st.tuples(st.integers(1, 20), st.just(3)), elements=st.integers(-2, 2)), seeds)
def test_a_lattice_has_a_box_with_as_many_sides_as_it_has_dimensions(points, seed):
    points = points.astype(float) @ turned(seed).T
    rotation, center, size = box(points)
    check_holds(points, rotation, center, size)
    assert np.count_nonzero(size) == np.linalg.matrix_rank(points - points[0], tol=1e-6)


@pytest.mark.parametrize("thickness", [1e-6, 1e-9, 1e-11, 1e-13, 1e-15])
def test_a_sheet_of_next_to_no_thickness_has_a_box(thickness):
    points = np.random.default_rng(0).uniform(-1, 1, (50, 3)) * [2, 1, thickness] @ turned(1).T + 30
    rotation, center, size = box(points)
    check_holds(points, rotation, center, size)
    assert size[2] <= 3 * thickness
    assert size[2] > 0 or thickness < 1e-7


def test_each_cluster_has_its_own_box_and_an_empty_one_zeros():
    one, other = cloud(1, 20), cloud(2, 30)
    rotation, center, size = least_volume_boxes(np.concatenate([one, other]), np.array([0, 20, 20, 50]))
    for k, points in ((0, one), (2, other)):
        for a, b in zip((rotation[k], center[k], size[k]), box(points), strict=True):
            assert np.array_equal(a, b)
    assert np.array_equal(rotation[1], np.eye(3))
    assert not center[1].any()
    assert not size[1].any()


@settings(max_examples=60, deadline=None)
@given(st.floats(-4, 4), st.floats(-0.5, 0.5), st.permutations(range(3)))
def test_the_heading_is_that_of_the_longest_axis_that_lies(yaw, pitch, order):
    R = Rotation.from_euler("ZY", [yaw, pitch]).as_matrix()[:, order]
    size = np.array([4.0, 1.5, 5.0])[order]  # higher than it is long
    found = heading_of(R[None], size[None])
    assert found.shape == (1,)
    assert 0 <= found[0] < np.pi / 2
    assert abs((found[0] - yaw + np.pi / 4) % (np.pi / 2) - np.pi / 4) < 1e-9


def test_a_line_heads_where_it_goes_and_a_place_nowhere():
    for rise in (0.0, 0.5, 4.0):
        rotation, _, size = box(np.outer(np.arange(4), [np.cos(0.7), np.sin(0.7), rise]))
        np.testing.assert_allclose(heading_of(rotation[None], size[None]), 0.7)
    rotation, _, size = least_volume_boxes(np.ones((1, 3)), np.array([0, 1]))
    assert heading_of(rotation, size)[0] == 0
    assert heading_of(np.zeros((0, 3, 3)), np.zeros((0, 3))).shape == (0,)


def test_a_heading_is_less_than_a_right_angle():
    R = Rotation.from_euler("Z", -1e-17).as_matrix()
    assert 0 <= heading_of(R[None], np.array([[2.0, 1, 1]]))[0] < np.pi / 2
