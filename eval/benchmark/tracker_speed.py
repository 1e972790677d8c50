"""How long a step of the tracker takes, beside filterpy's filters and Stone Soup's joint association."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from datmo.arrays import F64
from datmo.messages import Boxes
from datmo.tracks import Tracker
from datmo.tracks.estimate import Estimator
from eval.benchmark.stone_soup import joint_association
from eval.benchmark.table import Rows

WARM_UP = 15  # scans in which tracks are confirmed and code is compiled
SIZE, CLUTTER_HALF, STEP = (4.5, 1.8, 1.5), 100.0, 0.1
ASKED = {"50 tracks, 20 false boxes": (4.0, 8.0), "100 tracks": (10.0, None), "pile-up of 12": (25.0, None)}
"""Most milliseconds of a step, median and 99 %."""


@dataclass(frozen=True)
class Times:
    """Milliseconds of each step, and how many tracks it had at the end."""

    name: str
    steps: F64
    tracks: int


def cars(count: int, false: int, scans: int, apart: float, seed: int = 0) -> list[Boxes]:
    """Boxes of cars on a grid of `apart` [m], each with its own heading and speed, with misses and noise."""
    rng = np.random.default_rng(seed)
    side = int(np.ceil(np.sqrt(count)))
    start = apart * np.column_stack(np.divmod(np.arange(count), side)).astype(float)
    yaw, speed = rng.uniform(-np.pi, np.pi, count), rng.uniform(0, min(8.0, apart), count)
    made = []
    for k in range(scans):
        there = rng.random(count) < 0.95
        place = start + (k * STEP * speed)[:, None] * np.column_stack([np.cos(yaw), np.sin(yaw)])
        place = place[there] + rng.normal(0, 0.08, (int(there.sum()), 2))
        wrong = rng.uniform(-CLUTTER_HALF, CLUTTER_HALF, (false, 2)) + start.mean(axis=0)
        center = np.concatenate([place, wrong])
        turn = np.concatenate(
            [yaw[there] + rng.normal(0, 0.05, len(place)), rng.uniform(-np.pi, np.pi, false)]
        )
        made.append(
            Boxes(np.column_stack([center, np.zeros(len(center))]), np.tile(SIZE, (len(center), 1)), turn)
        )
    return made


def ours(name: str, scans: Sequence[Boxes]) -> Times:
    """Whole steps of the tracker, after a warm-up."""
    tracker, spent, tracks = Tracker(), [], None
    for k, boxes in enumerate(scans):
        start = perf_counter()
        tracks = tracker.step(boxes, STEP * k)
        spent.append(1e3 * (perf_counter() - start))
    return Times(name, np.array(spent[WARM_UP:]), 0 if tracks is None else int(tracks.confirmed().sum()))


def filters(name: str, engine: str, scans: Sequence[Boxes]) -> Times:
    """Prediction and correction alone: what `Estimator` spends in each step."""
    tracker, spent, tracks = Tracker(engine=engine), [], None  # type: ignore[arg-type]
    watch = _Watch(tracker._estimator)
    for k, boxes in enumerate(scans):
        watch.spent = 0.0
        tracks = tracker.step(boxes, STEP * k)
        spent.append(1e3 * watch.spent)
    return Times(name, np.array(spent[WARM_UP:]), 0 if tracks is None else int(tracks.confirmed().sum()))


class _Watch:
    """Counts the time that an estimator's predictions and updates take."""

    def __init__(self, estimator: Estimator) -> None:
        self.spent = 0.0
        for name in ("predict", "update"):
            setattr(estimator, name, self._timed(getattr(estimator, name)))

    def _timed(self, call: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*args: Any) -> Any:
            start = perf_counter()
            try:
                return call(*args)
            finally:
                self.spent += perf_counter() - start

        return timed


def measure(scans: int = 100) -> list[Times]:
    """Everything that the project asks of the tracker's speed, in one process."""
    fifty = cars(50, 20, scans, 12.0)
    return [
        ours("50 tracks, 20 false boxes", fifty),
        ours("100 tracks", cars(100, 0, scans, 12.0)),
        ours("pile-up of 12", cars(12, 0, scans, 0.9)),
        filters("filters alone, 50 tracks", "batched", fifty),
        filters("filterpy's filters alone", "filterpy", fifty[: WARM_UP + 6]),
        Times("Stone Soup's JPDA with EHM, 50 tracks", joint_association(*cars(50, 20, 2, 12.0)), 70),
    ]


def speed_table(times: Sequence[Times]) -> Rows:
    """Median and 99 % of each, in ms, beside what was asked."""
    rows = []
    for t in times:
        median, most = ASKED.get(t.name, (None, None))
        asked = " / ".join("-" if v is None else f"{v:g}" for v in (median, most))
        rows.append(
            (t.name, f"{np.median(t.steps):.2f}", f"{np.percentile(t.steps, 99):.2f}", asked, str(t.tracks))
        )
    return Rows("speed", ("step", "median [ms]", "99 % [ms]", "asked", "tracks"), tuple(rows), left=1)
