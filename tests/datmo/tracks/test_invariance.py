"""A whole run of the tracker, moved, turned, relabelled: the same states to 1e-9."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.geometry import wrap_angle
from datmo.messages import Boxes
from datmo.tracks import Tracker, TrackerConfig

METHODS = ("jpda", "pda", "gnn", "jipda")
FRAMES, DT = 15, 0.1


def scene(seed, n=10, clutter=4, area=20.0):
    """Boxes of turning movers near each other, with misses and clutter."""
    rng = np.random.default_rng(seed)
    place, yaw = rng.uniform(-area, area, (n, 2)), rng.uniform(-np.pi, np.pi, n)
    speed, rate = rng.uniform(0, 12, n), rng.uniform(-0.2, 0.2, n)
    for k in range(FRAMES):
        place = place + DT * speed[:, None] * np.column_stack([np.cos(yaw), np.sin(yaw)])
        yaw = yaw + DT * rate
        seen = rng.random(n) > 0.1
        center = np.vstack(
            [(place + rng.normal(0, 0.15, (n, 2)))[seen], rng.uniform(-area, area, (clutter, 2))]
        )
        turn = np.concatenate([(yaw + rng.normal(0, 0.05, n))[seen], rng.uniform(-3, 3, clutter)])
        m = len(center)
        size = np.tile([4.5, 1.8, 1.5], (m, 1))
        yield Boxes(np.column_stack([center, np.zeros(m)]), size, wrap_angle(turn)), DT * k


def run(frames, name):
    tracker = Tracker(TrackerConfig(association=name))
    return [tracker.step(boxes, stamp) for boxes, stamp in frames]


def assert_same(a, b, turn=0.0, shift=(0.0, 0.0, 0.0)):
    """States of b are those of a, turned and moved; lengths are compared over 100 m."""
    c, s = np.cos(turn), np.sin(turn)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    G = np.eye(5)
    G[:2, :2] = R[:2, :2]
    assert a[-1].confirmed().sum() >= 5
    for left, right in zip(a, b, strict=True):
        assert len(left) == len(right)
        i = np.lexsort((left.boxes.center @ R.T).round(6).T)
        j = np.lexsort((right.boxes.center - shift).round(6).T)
        want = left.boxes.center[i] @ R.T + shift
        np.testing.assert_allclose(right.boxes.center[j], want, rtol=1e-9, atol=1e-7)
        velocity = left.boxes.velocity[i] @ R[:2, :2].T
        np.testing.assert_allclose(right.boxes.velocity[j], velocity, rtol=1e-9, atol=1e-7)
        np.testing.assert_allclose(
            wrap_angle(right.boxes.yaw[j] - left.boxes.yaw[i] - turn), 0, rtol=0, atol=1e-8
        )
        np.testing.assert_allclose(right.mode_prob[j], left.mode_prob[i], rtol=1e-9, atol=1e-8)
        np.testing.assert_allclose(right.cov[j], G @ left.cov[i] @ G.T, rtol=1e-9, atol=1e-7)
        np.testing.assert_array_equal(right.status[j], left.status[i])


@pytest.mark.parametrize("name", METHODS)
def test_the_order_of_the_boxes_does_not_matter(name):
    rng = np.random.default_rng(0)
    assert_same(run(scene(1), name), run(((b.select(rng.permutation(len(b))), t) for b, t in scene(1)), name))


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize(("turn", "shift"), [(0.0, (80.0, -60.0, 3.0)), (2.1, (0.0, 0.0, 0.0))])
def test_a_moved_or_turned_world_gives_moved_or_turned_tracks(name, turn, shift):
    c, s = np.cos(turn), np.sin(turn)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    moved = ((Boxes(b.center @ R.T + shift, b.size, wrap_angle(b.yaw + turn)), t) for b, t in scene(2))
    assert_same(run(scene(2), name), run(moved, name), turn, shift)
