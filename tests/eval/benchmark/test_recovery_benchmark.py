"""Scenes of hiding, the tables and the curves of the recovery benchmark."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.errors import ConfigError
from datmo.tracks import TrackerConfig
from eval.benchmark import recovery_play
from eval.benchmark.recovery import ABLATIONS, BINS, Recovery, benchmark_recovery
from eval.benchmark.recovery_plot import recovery_curves
from eval.benchmark.recovery_report import shown, write
from eval.benchmark.recovery_scenes import EGO, MOTIONS, recovery_scene
from eval.metrics.recovery import Coast, Event
from sim.scene.script import Script


def event(duration=0.7, motion="straight", confusers=0, outcome="recovered", owner=1, error=0.4):
    coasts = {t: Coast(error * t, error * t, 0.0) for t in (1.0, 2.0, 3.0) if t < duration}
    return Event(
        1, 2.0, 2.0 + duration, motion, confusers, owner, outcome, False, 0.1, 0.1, coasts, [0.5, 4.0]
    )


def recovery(name="ours", events=None):
    events = events if events is not None else [(event(d), k) for k, d in enumerate([0.7, 1.5, 2.5, 4.0] * 5)]
    return Recovery(name, tuple(events), 3, (0.3,), (1.0, 2.0), (0.5,))


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("confusers", [False, True])
def test_a_scene_hides_its_owner_behind_the_wall_for_the_time_asked(motion, confusers):
    for seed in range(5):
        scene = recovery_scene(motion, (1.0, 2.0), confusers, seed)
        assert scene == recovery_scene(motion, (1.0, 2.0), confusers, seed)
        owners = [a for a in scene.actors if a.name.startswith("owner")]
        assert len(owners) == 4
        assert len(scene.actors) == 8
        for k, owner in enumerate(owners):  # nearer and farther on the one side, then on the other
            seconds = hidden_seconds(owner, scene.things[k // 2], scene.duration)
            least, most = (0.5, 2.4) if k % 2 == 0 else (0.6, 3.4)
            assert least <= seconds <= most, (seed, owner.name, seconds)  # a slow body hides a little later


def hidden_seconds(owner, wall, duration):
    """Time for which the middle of the body and both its ends lie in the shadow of the wall."""
    script, times = Script(owner), np.arange(0, duration, 0.02)
    place, yaw = script.position(times) - EGO, script.yaw(times)
    half = {"car": 4.5, "van": 5.2, "bicycle": 1.8, "pedestrian": 0.6}[owner.kind] / 2
    shadow = np.ones(len(times), bool)
    for end in (-half, 0.0, half):
        point = place + end * np.column_stack([np.cos(yaw), np.sin(yaw)])
        at = point[:, 1] * (wall.at[0] - EGO[0]) / point[:, 0]  # where the ray meets the wall's line
        shadow &= np.abs(at - (wall.at[1] - EGO[1])) < wall.size[0] / 2
    return shadow.sum() * 0.02


def test_confusers_come_near_while_it_is_hidden():
    near = 0
    for seed in range(10):
        scene = recovery_scene("straight", (2.0, 3.0), True, seed)
        for owner, other in zip(scene.actors[::2], scene.actors[1::2], strict=True):
            t = np.arange(0, scene.duration, 0.05)
            gap = np.linalg.norm(Script(owner).position(t) - Script(other).position(t), axis=1)
            near += gap.min() < 4
    assert near == 40


def test_tables_count_what_was_given():
    events = [(event(0.7, outcome="recovered"), 0)] * 3 + [(event(0.7, outcome="wrong"), 1)]
    events += [(event(1.5, owner=None, outcome="no owner"), 1)]
    rows = shown([recovery(events=events), recovery("Kalman")])
    assert rows[0].rows[0][1].startswith("0.75 (")
    assert rows[0].rows[0][1].endswith("; 4)")
    assert rows[1].rows[-1][1].startswith("0.25 (")
    assert rows[3].rows[0] == ("ours", "75 / 25", "-", "-", "-", "4")
    assert rows[2].rows[0][-2:] == ("1", "3")
    assert rows[2].rows[1][1:4] == ("0.40", "0.80", "1.20")
    assert all(len(row) == len(table.heads) for table in rows for row in table.rows)


def test_the_curves_and_files_are_written(tmp_path):
    results = [recovery(), recovery("Kalman", []), recovery("thesis")]
    assert recovery_curves(results)[:4] == b"\x89PNG"
    write(results, [0], tmp_path / "out", force=False)
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [
        "recovery.json",
        "recovery.md",
        "recovery.png",
    ]


def test_no_seed_is_refused_and_ablations_are_configurations():
    with pytest.raises(ConfigError, match="no seeds"):
        benchmark_recovery([])
    assert all(isinstance(c, TrackerConfig) and c != TrackerConfig() for c in ABLATIONS.values())
    assert len(BINS) == 4


def test_classes_with_enough_events_are_played_no_more(monkeypatch):
    """Each scene here gives two events of its class; three are enough, so two seeds of three are played."""
    asked, told = [], []

    def play(job):
        asked.append(job)
        found = [event(np.mean(job.seconds), job.motion, int(job.confusers))] * 2
        return {name: recovery_play.Played(found, 0, [], [], []) for name in ("ours", "Kalman")}

    monkeypatch.setattr("eval.benchmark.recovery.play", play)
    ours, _ = benchmark_recovery([4, 5, 6], {"Kalman": None}, tell=told.append, enough=3)
    alone = [(job.motion, job.seconds, job.seed) for job in asked if not job.confusers]
    assert sorted({seed for _, _, seed in alone}) == [4, 5]
    assert len(alone) == 24
    assert {job.seed for job in asked if job.confusers} == {4}  # three motions fill a class at once
    assert len(ours.events) == 2 * len(asked)
    assert told == sorted(told)
    assert told[-1] == 72


@pytest.mark.long
def test_ours_beside_itself_gives_the_same_tracks():
    job = recovery_play.Job(
        "straight", (0.5, 1.0), False, 7, beside={"again": TrackerConfig(), "Kalman": None}
    )
    played = recovery_play.play(job)
    assert played["ours"] == played["again"]
    assert len(played["ours"].events) >= 2
    assert all(e.outcome == "recovered" for e in played["ours"].events)
    assert set(played) == {"ours", "again", "Kalman"}
