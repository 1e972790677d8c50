"""Partial boxes: what is expected of a side never seen whole, and how little a cut one tells."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.messages import Boxes, Detections, Sight
from datmo.messages.sight import AZIMUTH_STEP, ELEVATION_STEP, HIGHEST, LOWEST
from datmo.tracks import Tracker, TrackerConfig
from datmo.tracks.measurement.ends import anchor, moved_middle

SHAPE = (round((HIGHEST - LOWEST) / ELEVATION_STEP), round(2 * np.pi / AZIMUTH_STEP))
X, SPEED, LENGTH, WIDTH = 12.0, 6.0, 4.4, 1.8
AZIMUTH = -np.pi + (np.arange(SHAPE[1]) + 0.5) * AZIMUTH_STEP


def sight(y0, y1, wall=None):
    """Rays that meet the near side of a car from y0 to y1 at x = 11.1, and a wall (x, y0, y1) before it."""
    reach = np.full(SHAPE[1], 80.0)
    for x, low, high in ([(X - WIDTH / 2, y0, y1)] if y1 > y0 else []) + ([wall] if wall else []):
        met = (np.abs(AZIMUTH) < 1.5) & (x * np.tan(AZIMUTH) >= low) & (x * np.tan(AZIMUTH) <= high)
        reach[met] = np.minimum(reach[met], x / np.cos(AZIMUTH[met]))
    image = np.tile(reach, (SHAPE[0], 1))
    return Sight(near=image, far=image, T_world_sensor=np.eye(4))


def near_side(y0, y1, turn=0.0):
    """The near side from y0 to y1, 0.2 m deep, as part of a whole car that goes along +y."""
    center = [X - WIDTH / 2 + 0.1, (y0 + y1) / 2, 0]
    part = Boxes([center], [[y1 - y0, 0.2, 1.5]], [np.pi / 2 + turn])
    whole = np.array([[X, (y0 + y1) / 2, 0]])
    return Detections(
        whole, [[LENGTH, WIDTH, 1.5]], part.yaw, seen=[[-(y1 - y0) / 2, (y1 - y0) / 2, 0.7, 0.9]]
    )


@pytest.mark.parametrize(("gain", "off"), [(0.1, 0.15), (0.0, 0.8)])
def test_a_car_of_which_one_side_is_seen_lies_where_the_detector_expects_its_middle(gain, off):
    tracker, start = Tracker(TrackerConfig(expected_gain=gain)), -12.0
    for k in range(35):
        y = start + 0.1 * SPEED * k
        ends = y - LENGTH / 2, y + LENGTH / 2
        tracks = tracker.step(near_side(*ends), 0.1 * k, sight(*ends))
    assert len(tracks) == 1
    assert abs(X - tracks.boxes.center[0, 0]) == pytest.approx(off, abs=0.12)
    assert tracks.boxes.size[0, 1] == pytest.approx(WIDTH if gain else 0.2, abs=0.15)


def test_what_is_no_vehicle_is_taken_as_it_is_seen():
    """Someone 0.6 m long, whom the detector takes for a car."""
    tracker = Tracker()
    for k in range(30):
        y = -6.0 + 0.1 * k
        box = Detections([[X, y, 0]], [[LENGTH, WIDTH, 1.5]], [np.pi / 2], seen=[[-0.3, 0.3, 0.7, 0.9]])
        tracks = tracker.step(box, 0.1 * k, sight(y - 0.3, y + 0.3))
    assert tracks.boxes.size[0, :2].max() < 1.0


def turned_by_a_wall(partial):
    """Heading [rad] to which a car turns that drives behind a wall beginning at y = 0 before it.

    The less of it is seen, the more that is turned, up to 0.25 rad.
    """
    tracker, heading = Tracker(TrackerConfig(partial_yaw=partial)), 0.0
    for k in range(40):
        back = -16.0 - LENGTH / 2 + 0.1 * SPEED * k
        front = min(back + LENGTH, 0.0)
        if front - back < 1.0:
            break
        lost = LENGTH - (front - back)
        turn = -0.08 * lost if lost > 0.05 else 0.0
        wall = (5.0, 0.0, 30.0)
        tracks = tracker.step(near_side(back, front, turn), 0.1 * k, sight(back, front, wall))
        heading = float(np.arctan2(*tracks.boxes.velocity[0]))
    return abs(heading)


def test_the_yaw_of_what_a_wall_cuts_off_hardly_turns_a_car():
    assert turned_by_a_wall(0.0) > 0.1
    assert turned_by_a_wall(2.0) < 0.8 * turned_by_a_wall(0.0)


def test_a_new_track_knows_its_speed_as_it_comes_out_from_behind_a_wall():
    """Its front moves at 6 m/s, the middle of what is seen of it at half of that."""
    tracker, seen = Tracker(), {}
    for k in range(1, 8):
        front = 0.1 * SPEED * k
        wall = (5.0, -30.0, 0.0)
        tracks = tracker.step(near_side(0.0, front), 0.1 * k, sight(0.0, front, wall))
        seen[k] = tracks.boxes.velocity[0], tracks.boxes.center[0], tracks.boxes.size[0, 0], front
    assert len(tracks) == 1
    for k in (4, 5, 6, 7):
        velocity, center, length, front = seen[k]
        assert velocity[1] == pytest.approx(SPEED, rel=0.15), k
        assert center[1] + length / 2 == pytest.approx(front, abs=0.4)


def test_the_middle_moves_away_from_the_end_that_stays():
    real = np.array([[[False, True], [True, True]], [[True, False], [False, True]], [[False, False]] * 2])
    held = anchor(real)
    assert held.tolist() == [[1, 0], [-1, 1], [0, 0]]
    moved = moved_middle(
        held, np.array([[2.0, 9.0], [2.0, 1.0], [5.0, 5.0]]), np.array([0.0, np.pi / 2, 1.0])
    )
    np.testing.assert_allclose(moved, [[-1, 0], [0.5, 1], [0, 0]], atol=1e-12)
