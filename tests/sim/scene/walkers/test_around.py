from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.geometry import corners_bev, overlap_bev
from sim.scene.clearance import shared
from sim.scene.walkers.boxes import Boxes
from sim.scene.walkers.contact import SIDE, keep_out, part
from sim.scene.walkers.sight import KEEP, look

AHEAD = np.array([1.0, 0.0])


def boxes(*rows: tuple[float, float, float, float, float], v: tuple[float, float] = (0, 0)) -> Boxes:
    a = np.array(rows, float).reshape(-1, 5)
    return Boxes(a[:, :2], a[:, 2:4] / 2, np.radians(a[:, 4]), np.tile(np.array(v, float), (len(a), 1)))


def test_the_gap_to_a_turned_box() -> None:
    one = boxes((1, 1, 4, 2, 90))
    points = np.array([[3.0, 1.0], [1.0, 4.5], [4.0, 7.0], [1.9, 1.0]])
    expected = [[[1, 0]], [[0, 1.5]], [[2, 4]], [[1e-5, 0]]]
    np.testing.assert_allclose(one.gap(points), expected, atol=1e-12)


def test_nothing_in_the_way_is_straight_on() -> None:
    np.testing.assert_allclose(
        look(np.zeros(2), np.array([0.6, 0.8]), np.array([3.0, 4.0]), 1.4, boxes()), [0.84, 1.12]
    )
    behind = boxes((-3, 0, 4, 2, 0), (9, 0, 1, 1, 0))  # the other is beyond the goal
    np.testing.assert_allclose(look(np.zeros(2), AHEAD, 2 * AHEAD, 1.4, behind), [1.4, 0], atol=1e-12)


def test_who_stands_before_a_wall_goes_along_it_to_its_nearer_end() -> None:
    wall = boxes((0, 3, 8, 0.3, 0))
    v = look(np.array([1.7, 2.0]), np.array([0.0, 1.0]), np.array([1.0, 8.0]), 1.4, wall)
    assert v[0] > 1.3
    v = look(np.array([-0.5, 2.4]), np.array([0.0, 1.0]), np.array([0.0, 8.0]), 1.4, wall)
    assert v[0] < -1.3


def test_a_wall_ahead_is_passed_on_its_nearer_side() -> None:
    v = look(np.zeros(2), AHEAD, 20 * AHEAD, 1.4, boxes((5, 1, 0.5, 4, 0)))
    assert v[1] < 0
    at = v * (4.75 / v[0])
    assert at[1] < -1 - KEEP
    assert np.hypot(*v) == pytest.approx(1.4)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6))
def test_after_contact_no_boxes_overlap(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x = rng.uniform(0, 1.5, (2, 2)) + np.array([[0, 0], [1.5, 0]])
    v, yaw = rng.normal(0, 1.5, (2, 2)), rng.uniform(-3, 3, 2)
    half, dt, both = np.tile([0.45, 0.28], (2, 1)), 0.05, np.array([True, True])
    if shared(*corners_bev(x, 2 * half, yaw)) > 0.0:
        return
    after = part(x, v, yaw, half, both, dt)
    assert overlap_bev(*corners_bev(x + dt * after, 2 * half, yaw)) == 0
    fixed = part(x, v, yaw, half, np.array([True, False]), dt)
    np.testing.assert_array_equal(fixed[1], v[1])


def test_those_who_overlap_are_parted_along_the_nearest_side() -> None:
    x, half = np.array([[0.0, 0.0], [0.1, 0.45]]), np.tile([0.5, 0.25], (2, 1))
    after = part(x, np.zeros((2, 2)), np.zeros(2), half, np.array([True, True]), 0.2)
    np.testing.assert_allclose(after, [[0, -0.15], [0, 0.15]], atol=1e-9)


def test_nobody_steps_into_a_vehicle_and_a_moving_one_pushes_ahead() -> None:
    wall = boxes((3, 0, 2, 10, 0))
    x, v = np.array([[1.55, 0.0]]), np.array([[1.4, 0.3]])
    after = keep_out(x, v, wall, 0.1)
    assert x[0, 0] + 0.1 * after[0, 0] == pytest.approx(2 - SIDE)
    assert after[0, 1] == 0.3
    moving = boxes((3, 0, 2, 10, 0), v=(-1.0, 0))
    assert keep_out(np.array([[1.6, 0.0]]), np.zeros((1, 2)), moving, 0.1)[0, 0] <= -1.0 + 1e-9
