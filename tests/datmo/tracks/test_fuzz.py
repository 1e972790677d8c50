"""Anything anywhere: nothing raises, nothing is not finite. `pytest -m long` plays a million scans."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.messages import Boxes, Sight
from datmo.messages.sight import AZIMUTH_STEP, ELEVATION_STEP, HIGHEST, LOWEST
from datmo.tracks import Tracker, TrackerConfig

METHODS = ("jpda", "pda", "gnn", "jipda")
FEW, MANY, SEEDS = 60, 50_000, 5
STEPS, CHANCES = (0.001, 0.1, 0.5, 5.0, 10.0), (0.05, 0.855, 0.06, 0.03, 0.005)


def scans(seed, count):
    """Boxes of six movers that leap now and then, and false ones; steps from a millisecond to ten seconds."""
    rng, stamp = np.random.default_rng(seed), 0.0
    place, drift = rng.uniform(-30, 30, (6, 2)), rng.normal(0, 6, (6, 2))
    for _ in range(count):
        step = float(rng.choice(STEPS, p=CHANCES))
        stamp += step
        drift += rng.normal(0, 1, (6, 2)) * np.sqrt(step)
        place = place + step * drift
        far = np.abs(place) > 60
        place, drift = np.clip(place, -60, 60), np.where(far, -0.5 * np.sign(place) * np.abs(drift), drift)
        if rng.random() < 0.003:
            place = place + rng.normal(0, 30, 2)
        seen, false = np.flatnonzero(rng.random(6) < 0.85), rng.poisson(1.5)
        n = len(seen) + false
        center = np.zeros((n, 3))
        center[:, :2] = np.vstack(
            [place[seen] + rng.normal(0, 0.2, (len(seen), 2)), rng.uniform(-60, 60, (false, 2))]
        )
        course = np.arctan2(drift[seen, 1], drift[seen, 0]) + rng.normal(0, 0.1, len(seen))
        yaw = np.concatenate([course, rng.uniform(-9, 9, false)]) + np.pi * rng.integers(0, 2, n)
        size = np.array([4.0, 1.8, 1.5]) * rng.lognormal(0, 0.3, (n, 3))
        if n and rng.random() < 0.02:
            size[0, rng.integers(3)] = rng.choice([np.nan, 0.0, -1.0, np.inf])
        yield Boxes(center=center, size=size, yaw=yaw), stamp


def play(seed, count, name):
    """Tracks live through gaps however uncertain they become; some are confirmed, or nothing is tried."""
    config = TrackerConfig(association=name, max_coast=6.0, max_position_std=200.0, dead_existence=1e-4)
    tracker, confirmed = Tracker(config), 0
    for boxes, stamp in scans(seed, count):
        tracks = tracker.step(boxes, stamp)
        assert_sound(tracks)
        confirmed += int(tracks.confirmed().sum())
    assert confirmed > count


def assert_sound(tracks):
    b = tracks.boxes
    for values in (b.center, b.size, b.yaw, b.velocity, tracks.cov, tracks.mode_prob):
        assert np.isfinite(values).all()
    assert np.linalg.eigvalsh(tracks.cov).min(initial=1) > 0
    np.testing.assert_allclose(tracks.mode_prob.sum(1), 1, atol=1e-9)
    assert len(set(b.id.tolist())) == len(tracks)


@pytest.mark.parametrize("name", METHODS)
def test_some_random_scans(name):
    play(0, FEW, name)


@pytest.mark.long
@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("seed", range(SEEDS))
def test_a_million_random_scans(name, seed):
    play(1 + seed, MANY, name)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("field", ["center", "size", "yaw", "score"])
def test_boxes_that_are_not_finite_are_left_out(field, bad):
    values = {"center": np.zeros((2, 3)), "size": np.ones((2, 3)), "yaw": np.zeros(2), "score": np.ones(2)}
    values["center"][1] = 9
    values[field].reshape(2, -1)[0, 0] = bad
    tracker = Tracker()
    assert len(tracker.step(Boxes(**values), 0.0)) == 1
    assert "1 of 2" in tracker.notes["boxes dropped"]


@pytest.mark.parametrize("name", METHODS)
def test_a_jump_of_the_ego_pose_is_survived(name):
    """The world shifts by forty metres and turns by a quarter under the sensor: old tracks go, new come."""
    shape = (round((HIGHEST - LOWEST) / ELEVATION_STEP), round(2 * np.pi / AZIMUTH_STEP))
    tracker, image = Tracker(TrackerConfig(association=name)), np.full(shape, 80.0)
    local, before = np.array([[12.0, 3, 0], [20, -6, 0], [-9, 4, 0]]), set()
    for k in range(30):
        T = np.eye(4)
        if k >= 12:
            T[:2, :2], T[:2, 3] = [[0, -1], [1, 0]], [40.0, -25.0]
        center = local @ T[:3, :3].T + T[:3, 3]
        boxes = Boxes(center, np.tile([4.5, 1.8, 1.5], (3, 1)), np.full(3, np.pi / 2 * (k >= 12)))
        tracks = tracker.step(boxes, 0.1 * k, Sight(near=image, far=image, T_world_sensor=T))
        assert_sound(tracks)
        if k == 11:
            before = set(tracks.boxes.id[tracks.confirmed()].tolist())
    assert len(before) == 3
    assert len(tracks) == 3
    assert not before & set(tracks.boxes.id.tolist())
    np.testing.assert_allclose(np.sort(tracks.boxes.center[:, 0]), np.sort(center[:, 0]), atol=0.1)
