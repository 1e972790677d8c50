"""Plays a scene through the whole loop, and other trackers beside it on the same boxes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from datmo.config import DatmoConfig
from datmo.messages import Boxes, Frame, Sight, Status, Tracks, Truth
from datmo.pipeline import Datmo
from datmo.refine import refine
from datmo.sight import make_sight
from datmo.tracks import Tracker, TrackerConfig
from eval.benchmark.recovery_scenes import Motion, recovery_scene
from eval.benchmark.tracker_rivals import PlainKalman
from eval.episode import episode
from eval.metrics.consistency import ConsistencyScores
from eval.metrics.detection import Matched, match_detections
from eval.metrics.ghosts import ghosts
from eval.metrics.history import NONE, History, Moment, moment
from eval.metrics.matching import Returns
from eval.metrics.pairing import Pairer
from eval.metrics.recovery import Event, recovery_events
from sim.env import LidarEnv


@dataclass(frozen=True)
class Job:
    """One scene. `beside`: further trackers by name; None is the plain Kalman filter."""

    motion: Motion
    seconds: tuple[float, float]
    confusers: bool
    seed: int
    config: DatmoConfig = field(default_factory=DatmoConfig)
    beside: Mapping[str, TrackerConfig | None] = field(default_factory=dict)


@dataclass(frozen=True)
class Played:
    """What one tracker made of one scene.

    Attributes:
        events: that hid and came out. censored: intervals that do not count.
        ghosts: seconds that each owner outlived its object.
        nees, nis: of matched tracks, in each scan, by dimension.
    """

    events: list[Event]
    censored: int
    ghosts: list[float]
    nees: list[float]
    nis: list[float]


class Judge:
    """Keeps what recovery needs to know of one tracker."""

    def __init__(self) -> None:
        self._pairer, self._moments = Pairer(), list[Moment]()
        self._consistency = ConsistencyScores()

    def add(
        self, frame: Frame, truth: Truth, returns: Returns, matched: Matched, nis: Mapping[int, float]
    ) -> None:
        """Take in one scan."""
        paired = self._pairer.pair(frame, truth, returns)
        empty = np.zeros(int(frame.tracks.confirmed().sum()), np.bool_)
        now = moment(frame, truth, paired, matched, empty)
        self._moments.append(now)
        fed = {track: int(now.fed[row]) for track, row in now.track_row.items() if now.fed[row] != NONE}
        self._consistency.add(frame, truth, paired, fed, nis)

    def result(self) -> Played:
        """Over all scans."""
        history = History(self._moments)
        events, censored = recovery_events(history)
        seconds = [g.seconds for g in ghosts(history)]
        return Played(events, censored, seconds, *self._consistency.samples())


def play(job: Job) -> dict[str, Played]:
    """What each tracker made of the scene; "ours" runs in the loop and hands its predictions back."""
    scenario = recovery_scene(job.motion, job.seconds, job.confusers, job.seed)
    env, datmo = LidarEnv(scenario), Datmo(job.config)
    others = {n: Kalman() if c is None else Plain(c) for n, c in job.beside.items()}
    judges = {name: Judge() for name in ("ours", *others)}
    try:
        for info in episode(env, scenario, job.seed, scenario.scans):
            frame, truth = datmo.step(info["scan"]), info["truth"]
            returns = Returns(frame, truth)
            matched = match_detections(frame, truth, returns)
            sight = make_sight(frame.scan, refine(frame.scan, job.config.refine)) if others else None
            nis = {i: value for i, (value, _) in datmo.tracker.nis.items()}
            judges["ours"].add(frame, truth, returns, matched, nis)
            for name, other in others.items():
                tracks, nis = other.step(frame.boxes, frame.scan.stamp, sight)
                judges[name].add(replace(frame, tracks=tracks), truth, returns, matched, nis)
    finally:
        env.close()
    return {name: judge.result() for name, judge in judges.items()}


class Plain:
    """This project's tracker with another configuration, on boxes that are given."""

    def __init__(self, config: TrackerConfig) -> None:
        self._tracker = Tracker(config)

    def step(self, boxes: Boxes, stamp: float, sight: Sight | None) -> tuple[Tracks, dict[int, float]]:
        """Tracks and their normalised innovations squared, by id."""
        tracks = self._tracker.step(boxes, stamp, sight)
        return tracks, {i: value for i, (value, _) in self._tracker.nis.items()}


class Kalman(Plain):
    """The plain Kalman filter, its tracks as messages; it knows no covariance that could be judged."""

    def __init__(self) -> None:
        self._rival = PlainKalman(min_score=0.0, coasting=True)

    def step(self, boxes: Boxes, stamp: float, sight: Sight | None) -> tuple[Tracks, dict[int, float]]:  # noqa: ARG002
        """See `Plain`."""
        shown = self._rival.step(boxes, stamp)
        n = len(shown)
        status = np.full(n, int(Status.TRACKING), np.uint8)
        return Tracks(shown, stamp=stamp, status=status, is_dynamic=np.ones(n, np.bool_)), {}
