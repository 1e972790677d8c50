"""The tracker as a whole: invariances, engines, bad input, time."""

from __future__ import annotations

from time import perf_counter

import numpy as np
import pytest

from datmo.errors import ConfigError, DatmoError
from datmo.geometry import wrap_angle
from datmo.messages import Boxes
from datmo.tracks import Tracker, TrackerConfig
from datmo.tracks.management.manage import status
from datmo.tracks.models import make_models


def scene(seed, frames=25, n=12, clutter=5, dt=0.1, area=40.0):
    """Noisy boxes of turning movers with misses, heads and tails alike, and clutter."""
    rng = np.random.default_rng(seed)
    place, yaw = rng.uniform(-area, area, (n, 2)), rng.uniform(-np.pi, np.pi, n)
    speed, rate = rng.uniform(0, 12, n), rng.uniform(-0.2, 0.2, n)
    for k in range(frames):
        place = place + dt * speed[:, None] * np.column_stack([np.cos(yaw), np.sin(yaw)])
        yaw = yaw + dt * rate
        seen = rng.random(n) > 0.1
        center = np.vstack(
            [(place + rng.normal(0, 0.15, (n, 2)))[seen], rng.uniform(-area, area, (clutter, 2))]
        )
        m = len(center)
        turn = np.concatenate([(yaw + rng.normal(0, 0.05, n))[seen], rng.uniform(-3, 3, clutter)])
        yield (
            Boxes(
                center=np.column_stack([center, np.zeros(m)]),
                size=np.tile([4.5, 1.8, 1.5], (m, 1)),
                yaw=wrap_angle(turn + np.pi * rng.integers(0, 2, m)),
            ),
            k * dt,
        )


def run(boxes, **kwargs):
    tracker = Tracker(**kwargs)
    return [tracker.step(b, t) for b, t in boxes], tracker


def test_both_engines_give_the_same_tracks():
    a, _ = run(scene(0, n=6))
    b, _ = run(scene(0, n=6), engine="filterpy")
    assert a[-1].confirmed().sum() >= 5
    for left, right in zip(a, b, strict=True):
        np.testing.assert_array_equal(left.boxes.id, right.boxes.id)
        np.testing.assert_array_equal(left.status, right.status)
        np.testing.assert_allclose(left.boxes.center, right.boxes.center, atol=1e-8)
        np.testing.assert_allclose(left.mode_prob, right.mode_prob, atol=1e-8)
        np.testing.assert_allclose(left.cov, right.cov, atol=1e-7)


def test_same_input_same_bytes():
    a, b = run(scene(3))[0], run(scene(3))[0]
    assert all(left == right for left, right in zip(a, b, strict=True))


def test_a_circle_is_followed_through_pi_without_a_flip():
    tracker, radius, rate = Tracker(TrackerConfig(given_std=(0.1, 0.1))), 12.0, 0.6
    rng = np.random.default_rng(0)
    for k in range(120):
        angle = rate * 0.1 * k
        place = radius * np.array([np.cos(angle), np.sin(angle)]) + rng.normal(0, 0.1, 2)
        yaw = wrap_angle(angle + np.pi / 2 + np.pi * rng.integers(2) + rng.normal(0, 0.03))
        tracks = tracker.step(Boxes([[*place, 0]], [[4.5, 1.8, 1.5]], [float(yaw)]), 0.1 * k)
        assert len(tracks) == 1
        if k > 15:
            assert abs(wrap_angle(tracks.boxes.yaw[0] - angle - np.pi / 2)) < 0.25
            assert np.hypot(*tracks.boxes.velocity[0]) == pytest.approx(radius * rate, rel=0.2)
    assert tracks.mode_prob[0].argmax() == 1  # CTRV
    x, y = tracks.boxes.center[0, :2]
    assert np.hypot(x, y) == pytest.approx(radius, abs=0.4)


def test_innovations_are_consistent():
    """NIS over matched noise: its mean is the dimension."""
    config = TrackerConfig(position_std=0.15, given_std=(0.15, 0.15))
    values = []
    for seed in range(5):
        tracker = Tracker(config)
        for b, t in scene(seed, frames=40, clutter=0, area=150.0):
            tracker.step(b, t)
            if t > 1.5:
                values += [nis / dim for nis, dim in tracker.nis.values()]
    assert len(values) > 500
    assert 0.6 < np.mean(values) < 1.2


def test_table_4_1():
    assert status(np.array([0.0, 0.01, 0.25, 0.45, 0.65, 0.99])).tolist() == [5, 6, 7, 8, 9, 10]
    tracker, seen = Tracker(TrackerConfig(max_coast=1.0)), []
    one = Boxes([[5, 5, 0]], [[4.5, 1.8, 1.5]], [0.1])
    for k in range(20):
        tracks = tracker.step(one if k < 8 else Boxes.empty(), 0.1 * k)
        seen.append(int(tracks.status[0]) if len(tracks) else 0)
    assert seen[:8] == [1, 2, 3, 4, 5, 5, 5, 5]
    assert seen[8:18] == [6, 7, 7, 8, 8, 9, 9, 10, 10, 0]
    assert seen[18:] == [0, 0]


def test_a_miss_before_confirmation_is_allowed_once():
    one, none = Boxes([[5, 5, 0]], [[4.5, 1.8, 1.5]], [0.1]), Boxes.empty()
    for pattern, alive in (([1, 1, 0, 1, 1, 1], True), ([1, 0, 1, 0, 1, 1], False)):
        tracker = Tracker()
        first = None
        for k, hit in enumerate(pattern):
            tracks = tracker.step(one if hit else none, 0.1 * k)
            first = first or int(tracks.boxes.id[0])
        assert (first in tracks.boxes.id.tolist()) is alive


@pytest.mark.parametrize(("score", "at"), [(9.0, 0), (6.0, 1), (5.0, 2), (4.0, 3)])
def test_logits_confirm_by_what_they_say(score, at):
    one = Boxes([[5, 5, 0]], [[4.5, 1.8, 1.5]], [0.1], score=[score])
    tracker = Tracker()
    seen = [int(tracker.step(one, 0.1 * k).status[0]) for k in range(6)]
    assert next(k for k, s in enumerate(seen) if s >= 5) == at


def test_unlikely_logits_start_no_track_and_shares_count_by_hits():
    def born(score, **config):
        tracker = Tracker(TrackerConfig(**config))
        return len(tracker.step(Boxes([[5, 5, 0]], [[4.5, 1.8, 1.5]], [0.1], score=[score]), 0.0).boxes)

    assert born(2.0) == 0
    assert born(2.0, scores="ignored") == 1
    assert born(0.2) == 1
    assert born(0.2, scores="logit") == 0


def test_boxes_of_little_trust_move_a_track_less():
    def pull(score):
        tracker = Tracker(TrackerConfig(scores="logit"))
        for k in range(8):
            tracker.step(Boxes([[10.0, 0, 0]], [[4.5, 1.8, 1.5]], [0.0], score=[9.0]), 0.1 * k)
        moved = tracker.step(Boxes([[10.2, 0, 0]], [[5.0, 1.8, 1.5]], [0.0], score=[score]), 0.8).boxes
        return moved.center[0, 0] - 10, moved.size[0, 0] - 4.5

    assert 0 < pull(2.5)[0] < 0.8 * pull(9.0)[0]
    assert 0 < pull(2.5)[1] < 0.8 * pull(9.0)[1]


def test_ids_are_never_used_twice():
    tracker, seen = Tracker(), set()
    for _ in range(3):
        ids = set()
        for b, t in scene(4, frames=12):
            ids |= set(tracker.step(b, t).boxes.id.tolist())
        assert not ids & seen
        seen |= ids
        tracker.reset()


def test_predicted_changes_nothing_and_looks_ahead():
    tracker = Tracker()
    for k in range(15):
        tracks = tracker.step(Boxes([[k * 1.0, 0, 0]], [[4.5, 1.8, 1.5]], [0.0]), 0.1 * k)
    ahead = tracker.predicted(1.4 + 0.5)
    assert ahead.center[0, 0] == pytest.approx(14 + 5, abs=0.7)
    assert ahead.id.tolist() == tracks.boxes.id.tolist()
    again = tracker.predicted(1.4)
    np.testing.assert_array_equal(again.center, tracks.boxes.center)
    assert len(Tracker().predicted(3.0)) == 0


def test_two_parked_cars_side_by_side_stay_two_and_a_repeat_dies():
    pair = Boxes([[5, 0, 0], [5, 2.6, 0]], [[4.5, 1.8, 1.5]] * 2, [0.0, 0.0])
    tracker = Tracker()
    for k in range(30):
        tracks = tracker.step(pair, 0.1 * k)
    assert tracks.confirmed().sum() == 2


@pytest.mark.parametrize("bad", [[np.nan, 1, 1], [0, 1, 1], [-1, 1, 1], [np.inf, 1, 1]])
def test_bad_boxes_are_left_out_with_a_note(bad):
    tracker = Tracker()
    tracks = tracker.step(Boxes([[1, 2, 0], [8, 8, 0]], [bad, [4, 2, 1.5]], [0.0, 0.0]), 0.0)
    assert len(tracks) == 1
    assert "1 of 2" in tracker.notes["boxes dropped"]


@pytest.mark.parametrize("stamp", [1.0, 0.5, np.nan, np.inf])
def test_time_must_go_on(stamp):
    tracker = Tracker()
    tracker.step(Boxes.empty(), 1.0)
    with pytest.raises(DatmoError, match=r"reset|finite"):
        tracker.step(Boxes.empty(), stamp)
    tracker.step(Boxes.empty(), 1.1)
    tracker.reset()
    tracker.step(Boxes.empty(), 0.0)


def test_a_jump_of_ten_seconds_ends_the_tracks_and_says_so():
    tracker = Tracker()
    for b, t in scene(6, frames=10):
        tracker.step(b, t)
    tracks = tracker.step(Boxes.empty(), 11.0)
    assert len(tracks) == 0
    assert "10.1 s" in tracker.notes["gap"]


def test_no_boxes_for_a_minute_then_on():
    tracker = Tracker()
    for k in range(600):
        assert len(tracker.step(Boxes.empty(), 0.1 * k)) == 0
    for b, t in scene(7, frames=8):
        tracks = tracker.step(b, 60 + t)
    assert tracks.confirmed().any()


def test_a_thousand_boxes_at_once():
    rng = np.random.default_rng(8)
    tracker = Tracker()
    center = np.column_stack([rng.uniform(-60, 60, (1000, 2)), np.zeros(1000)])
    boxes = Boxes(center=center, size=np.tile([4.0, 1.8, 1.5], (1000, 1)), yaw=np.zeros(1000))
    start = perf_counter()
    for k in range(7):
        tracks = tracker.step(boxes, 0.1 * k)
    assert perf_counter() - start < 20
    assert tracks.confirmed().sum() > 300


def test_wrong_settings_are_named():
    with pytest.raises(ConfigError, match="batched"):
        Tracker(engine="kalman")
    with pytest.raises(ValueError, match="sum to zero"):
        TrackerConfig(transition_rates=((1.0, 0, 0), (0, 0, 0), (0, 0, 0)))
    with pytest.raises(ValueError, match="Extra inputs"):
        TrackerConfig(gate=3)


@pytest.mark.parametrize("models", [("ctra",), ("cv", "ctrv", "ctra"), ("cca", "csav", "rm")])
def test_models_that_know_acceleration_follow_who_brakes_on_an_arc(models):
    tracker, state = Tracker(TrackerConfig(models=models)), np.array([[10.0, 0, 0.5, 12.0, 0.3, -1.5]])
    motion = make_models(TrackerConfig(models=("ctra",)))[0]
    for k in range(60):
        tracks = tracker.step(Boxes([[*state[0, :2], 0.8]], [[4.5, 1.8, 1.5]], state[0, 2:3]), k * 0.1)
        state = motion.propagate(state, 0.1)
    assert len(tracks.boxes) == 1
    assert tracks.cov.shape == (1, 5, 5)
    back = motion.propagate(state, -0.1)[0]
    assert np.hypot(*(tracks.boxes.center[0, :2] - back[:2])) < 0.1
    assert np.hypot(*tracks.boxes.velocity[0]) == pytest.approx(back[3], abs=0.3)
