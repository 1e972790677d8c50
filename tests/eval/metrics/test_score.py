from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.arrays import F64
from datmo.messages import Boxes, Frame, Ground, Kind, Relief, Scan, Surface, Tracks, Truth, Visibility
from eval.metrics.ground import grid_centres
from eval.score import NO_TRACKS, Scorer
from scenarios.expect import UNITS

STEP_NAMES = {n for n in UNITS if n.startswith(("ground.", "detection."))} | {"tracking.gospa", NO_TRACKS}


@dataclass(frozen=True)
class Slope(Surface):
    """z = -1.73 + 0.05 x."""

    std: float = 0.05

    def __call__(self, xy: F64) -> tuple[F64, F64]:
        return -1.73 + 0.05 * xy[:, 0], np.full(len(xy), self.std)


def world(make: Any, rng: np.random.Generator, scan: int, start: F64, kind: Any) -> tuple[Truth, Relief, F64]:
    """Objects that drive over a slope and hide now and then, with returns of all sorts."""
    k = len(start)
    hides = (np.arange(k) % 3 == 0) & (10 <= scan < 18)
    boxes = make.boxes(start + np.array([scan * 1.0, 0]), kind=kind, ids=np.arange(k) + 30)
    ground = np.column_stack([rng.uniform(-45, 45, (300, 2)), np.zeros(300)])
    ground[:, 2] = -1.73 + 0.05 * ground[:, 0]
    owner = np.repeat(np.flatnonzero(~hides), 6)
    hits = boxes.center[owner] + rng.uniform(-0.2, 0.2, (len(owner), 3))
    points = np.concatenate([ground, hits])
    n = len(points)
    truth = make.truth(
        boxes,
        stamp=scan / 10,
        visibility=np.where(hides, Visibility.HIDDEN, rng.choice([2, 3, 4], k)),
        returns=np.where(hides, 0, 6),
        actor=np.concatenate([np.full(300, -1), owner]),
        kind=np.concatenate([np.full(300, Kind.FIELD), kind[owner]]),
        is_ground=np.arange(n) < 300,
        height=-1.73 + 0.05 * points[:, 0],
    )
    xy = grid_centres()
    return truth, make.relief(xy, -1.73 + 0.05 * xy[:, 0], kind=Kind.FIELD), points


def perfect(truth: Truth, points: F64, names: Any) -> Frame:
    """The truth, fed back as if perception had found it."""
    seen = truth.boxes.select(truth.visibility > Visibility.HIDDEN)
    boxes = Boxes(truth.boxes.center, truth.boxes.size, truth.boxes.yaw, truth.boxes.velocity, id=names)
    ground = Ground(truth.is_ground, truth.height, np.full(len(points), 0.05), Slope())
    tracks = Tracks(boxes, stamp=truth.stamp, is_dynamic=np.ones(len(boxes), bool))
    return Frame(Scan(points, stamp=truth.stamp), ground, None, seen, tracks)  # type: ignore[arg-type]


def play(make: Any, seed: int, names: Any = None, scans: int = 40) -> tuple[Scorer, list[dict[str, Any]]]:
    rng = np.random.default_rng(seed)
    k = 7
    start = np.column_stack([rng.uniform(-20, 20, k), 10.0 * np.arange(k) - 30])
    kind = rng.choice([Kind.CAR, Kind.PEDESTRIAN, Kind.TRUCK], k)
    kind[0] = Kind.CAR
    names = np.arange(k) if names is None else names
    scorer, steps = Scorer(), []
    for scan in range(scans):
        truth, relief, points = world(make, rng, scan, start, kind)
        steps.append(scorer.add(perfect(truth, points, names), truth, relief, {}))
    return scorer, steps


def values(scorer: Scorer) -> dict[str, float | None]:
    return {m.name: m.value for m in scorer.result()}


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_perfect_perception_scores_perfectly(make: Any, seed: int) -> None:
    scorer, steps = play(make, seed)
    got = values(scorer)
    for name in ("precision", "recall", "f1", "obstacle_precision", "obstacle_recall", "coverage95"):
        assert got[f"ground.{name}"] == 1.0
    for name in ("ground.leak", "ground.height_rmse", "ground.height_rmse_unseen", "tracking.gospa"):
        assert got[name] == pytest.approx(0, abs=1e-6)
    for name in ("detection.precision", "detection.recall", "detection.recall_vehicles_40m", "detection.iou"):
        assert got[name] == pytest.approx(1)
    for name in ("hota", "mota", "idf1"):
        assert got[f"tracking.{name}"] == pytest.approx(1)
    assert got["tracking.id_switches"] == got["tracking.fragmentations"] == got["tracking.motp"] == 0
    assert (got["recovery.events"], got["recovery.rate"], got["recovery.wrong_rate"]) == (3, 1, 0)
    assert got["recovery.latency"] == got["consistency.nees"] == 0
    assert {scorer.reward(step) for step in steps} == {1.0}
    assert all(step.keys() == STEP_NAMES for step in steps)


def test_names_of_tracks_do_not_matter(make: Any) -> None:
    names = np.random.default_rng(0).permutation(7) * 13 + 1000
    assert values(play(make, 1)[0]) == values(play(make, 1, names)[0])


def test_nothing_gives_none(make: Any) -> None:
    assert {m.value for m in Scorer().result()} == {None}
    scorer = Scorer()
    step = scorer.add(make.frame(), make.truth(make.boxes([])), make.relief())
    assert {n: v for n, v in step.items() if v is not None} == {"tracking.gospa": 0.0, NO_TRACKS: 0.0}
    assert scorer.reward(step) == 0.0
    # Both sets empty make a GOSPA of 0; everything else had nothing to measure.
    assert {n for n, v in values(scorer).items() if v is not None} == {"tracking.gospa"}


def test_result_has_every_name_and_its_unit(make: Any) -> None:
    scorer, _ = play(make, 2, scans=3)
    for ms in (3.0, 9.0, 4.0):
        scorer.add_times({"speed.step_ms": ms})
    assert {m.name: m.unit for m in scorer.result()} == UNITS
    assert [m.name for m in scorer.result()] == list(UNITS)
    assert values(scorer)["speed.step_ms"] == 4.0
    assert all(m.value is None or type(m.value) is float for m in scorer.result())


def test_detail_goes_through_json(make: Any) -> None:
    detail = play(make, 3)[0].detail()
    assert json.loads(json.dumps(detail, allow_nan=False))["recovery"]["events"] == 3
    assert detail["recovery"]["by_duration"]["0.5-1"]["events"] == 3


@pytest.mark.parametrize(
    ("step", "reward"),
    [
        ({"ground.f1": 0.9, "ground.leak": 0.1}, 0.81),
        ({"ground.f1": 0.9, "ground.leak": None}, 0.9),
        ({"detection.precision": 0.5, "detection.recall": 1.0}, 2 / 3),
        ({"detection.precision": None, "detection.recall": 0.0}, 0.0),
        ({"detection.precision": None, "detection.recall": None}, 0.0),
        ({"tracking.gospa": 1.0, NO_TRACKS: 4.0}, 0.75),
        ({"tracking.gospa": 9.0, NO_TRACKS: 4.0}, 0.0),
        ({"tracking.gospa": 4.0, NO_TRACKS: 0.0}, 0.0),
        ({"tracking.gospa": 0.0, NO_TRACKS: 0.0, "ground.f1": 1.0}, 1.0),
        ({"ground.f1": 0.6, "tracking.gospa": 4.0, NO_TRACKS: 4.0}, 0.3),
    ],
)  # fmt: skip
def test_reward(step: dict[str, float | None], reward: float) -> None:
    assert Scorer().reward(step) == pytest.approx(reward)


def test_gospa_of_no_tracks_is_what_no_tracks_score(make: Any) -> None:
    truth = make.truth(make.boxes([(0, 0), (9, 0), (20, 0)]))
    step = Scorer().add(make.frame(), truth, make.relief())
    assert step["tracking.gospa"] == pytest.approx(step[NO_TRACKS])
    assert step[NO_TRACKS] == pytest.approx(np.sqrt(3 * 8))
