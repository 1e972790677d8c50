"""Headings that the motion belies."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.geometry import wrap_angle
from datmo.messages import Boxes
from datmo.tracks import Tracker


@pytest.mark.parametrize("way", [0.0, np.pi / 2, 3.0])
def test_a_track_born_across_its_motion_is_turned_along_it(way):
    """A box seen end on is as long across the motion, until the side comes into view."""
    tracker, along = Tracker(), np.array([np.cos(way), np.sin(way)])
    for k in range(30):
        across = k < 12
        size, yaw = ([2.6, 1.4, 1.5], way + np.pi / 2) if across else ([4.5, 1.8, 1.5], way)
        place = np.append(7.0 * 0.1 * k * along, 0.0)
        tracks = tracker.step(Boxes(place[None], [size], [float(wrap_angle(yaw))]), 0.1 * k)
        if k == 11:
            assert tracks.boxes.velocity[0] == pytest.approx(7 * along, abs=1.5)
    assert len(tracks) == 1
    assert tracks.boxes.velocity[0] == pytest.approx(7 * along, abs=0.5)
    assert abs(wrap_angle(tracks.boxes.yaw[0] - way)) < 0.1
    assert tracks.boxes.size[0, 0] > 2 * tracks.boxes.size[0, 1]


def test_a_standing_car_is_left_alone():
    tracker, rng = Tracker(), np.random.default_rng(0)
    for k in range(40):
        place = np.append(rng.normal(0, 0.05, 2), 0.0)
        tracks = tracker.step(Boxes(place[None], [[4.5, 1.8, 1.5]], [0.3]), 0.1 * k)
    assert len(tracks) == 1
    assert abs(tracks.boxes.yaw[0] - 0.3) < 0.05 or abs(abs(tracks.boxes.yaw[0] - 0.3) - np.pi) < 0.05
    assert np.hypot(*tracks.boxes.velocity[0]) < 0.3
