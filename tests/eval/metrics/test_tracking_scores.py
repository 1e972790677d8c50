from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.arrays import Array
from datmo.messages import Kind, Visibility
from eval.metrics.gospa import gospa
from eval.metrics.matching import Returns
from eval.metrics.pairing import Paired, Pairer
from eval.metrics.tracking import Clear, TrackingScores, hota, idf1

SEEDS = st.integers(0, 2**32 - 1)
KINDS = np.array([Kind.CAR, Kind.PEDESTRIAN, Kind.TRUCK, Kind.CAR, Kind.PEDESTRIAN, Kind.CAR])


def play(make: Any, scans: list[tuple[Any, Any]]) -> Iterator[Paired]:
    pairer = Pairer()
    for boxes, tracks in scans:
        frame, truth = make.frame(tracks=tracks), make.truth(boxes)
        yield pairer.pair(frame, truth, Returns(frame, truth))


def crowd(make: Any, seed: int, apart: float) -> list[tuple[Any, Any]]:
    """Six objects that come and go, tracked with noise, misses, swaps and false tracks."""
    rng = np.random.default_rng(seed)
    start = rng.uniform(0, apart, (6, 2)) + apart * np.arange(6)[:, None]
    swap = np.arange(6)
    scans = []
    for k in range(12):
        there = np.flatnonzero(rng.random(6) < 0.85)
        there = there if len(there) else np.array([0])
        if rng.random() < 0.3:
            swap = rng.permutation(6)
        place = start + np.array([0.5 * k, 0])
        seen = rng.permutation(there)[: max(1, len(there) - rng.integers(0, 3))]
        false = rng.uniform(-100, -50, (rng.integers(0, 2), 2))
        spots = np.concatenate([place[seen] + rng.normal(0, 1.0, (len(seen), 2)), false])
        ids = np.concatenate([swap[seen] + 100, 500 + np.arange(len(false))])
        scans.append((make.boxes(place[there], kind=KINDS[there], ids=there), make.tracks(spots, ids=ids)))
    return scans


def as_trackeval(frames: list[Paired]) -> dict[str, Any]:
    objects = np.unique(np.concatenate([p.object_id for p in frames]))
    tracks = np.unique(np.concatenate([p.track_id for p in frames]))
    return {
        "gt_ids": [np.searchsorted(objects, p.object_id) for p in frames],
        "tracker_ids": [np.searchsorted(tracks, p.track_id) for p in frames],
        "similarity_scores": [p.similarity for p in frames],
        "num_gt_ids": len(objects),
        "num_tracker_ids": len(tracks),
        "num_gt_dets": sum(len(p.object_id) for p in frames),
        "num_tracker_dets": sum(len(p.track_id) for p in frames),
        "num_timesteps": len(frames),
    }


@settings(max_examples=25, deadline=None)
@given(SEEDS, st.sampled_from([2.0, 5.0, 40.0]))
def test_agrees_with_trackeval(make: Any, seed: int, apart: float) -> None:
    from trackeval.metrics import CLEAR, HOTA, Identity

    frames = list(play(make, crowd(make, seed, apart)))
    data = as_trackeval(frames)
    scores = TrackingScores()
    for paired in frames:
        scores.add(paired)
    got, parts = scores.scores(), scores.detail()
    clear = CLEAR({"PRINT_CONFIG": False}).eval_sequence(data)
    assert got["tracking.mota"] == pytest.approx(clear["MOTA"], abs=1e-9)
    assert got["tracking.id_switches"] == clear["IDSW"]
    assert parts["clear"]["matched"] == clear["CLR_TP"]
    similarity = [p.similarity[tuple(p.pairs.T)].sum() for p in frames]
    assert sum(similarity) == pytest.approx(clear["MOTP_sum"], abs=1e-9)
    identity = Identity({"PRINT_CONFIG": False}).eval_sequence(data)
    assert got["tracking.idf1"] == pytest.approx(identity["IDF1"], abs=1e-9)
    want = HOTA().eval_sequence(data)
    for name, key in (("hota", "HOTA"), ("deta", "DetA"), ("assa", "AssA"), ("loca", "LocA")):
        assert parts["hota"][name] == pytest.approx(want[key].mean(), abs=1e-9)


@settings(max_examples=10, deadline=None)
@given(SEEDS)
def test_agrees_with_motmetrics(make: Any, seed: int) -> None:
    import motmetrics

    frames = list(play(make, crowd(make, seed, 40.0)))
    log = motmetrics.MOTAccumulator(auto_id=True)
    scores = TrackingScores()
    for p in frames:
        scores.add(p)
        log.update(p.object_id, p.track_id, np.where(p.similarity >= 0.5, 1 - p.similarity, np.nan))
    names = ["mota", "idf1", "num_switches", "num_fragmentations"]
    want = motmetrics.metrics.create().compute(log, metrics=names).iloc[0]
    got = scores.scores()
    assert got["tracking.mota"] == pytest.approx(want["mota"], abs=1e-9)
    assert got["tracking.idf1"] == pytest.approx(want["idf1"], abs=1e-9)
    assert got["tracking.id_switches"] == want["num_switches"]
    assert got["tracking.fragmentations"] == want["num_fragmentations"]


@settings(max_examples=25, deadline=None)
@given(SEEDS, st.integers(0, 6), st.integers(0, 6))
def test_gospa_agrees_with_stone_soup(seed: int, k: int, m: int) -> None:
    from stonesoup.metricgenerator.ospametric import GOSPAMetric
    from stonesoup.types.state import State

    rng = np.random.default_rng(seed)
    a, b = rng.uniform(0, 12, (k, 2)), rng.uniform(0, 12, (m, 2))
    got = gospa(np.linalg.norm(a[:, None] - b, axis=2))
    if k + m == 0:
        assert got.distance == 0
        return
    now = datetime(2020, 1, 1)
    states = [[State(x[:, None], timestamp=now) for x in s] for s in (b, a)]
    want = GOSPAMetric(p=2, c=4).compute_gospa_metric(*states)[0].value
    for name in ("distance", "localisation", "missed", "false"):
        assert getattr(got, name) == pytest.approx(want[name], abs=1e-9)


def test_gospa_of_a_forbidden_pair_is_a_miss_and_a_false_track() -> None:
    got = gospa(np.array([[1.0]]), np.array([[False]]))
    assert (got.missed, got.false, got.distance) == (8.0, 8.0, 4.0)


def run_clear(make: Any, scans: list[tuple[Any, Any]]) -> dict[str, Any]:
    clear = Clear()
    for paired in play(make, scans):
        clear.add(paired)
    return {**clear.scores(), **clear.detail()}


def test_switches_across_a_gap_and_fragments(make: Any) -> None:
    one, nothing = make.boxes([(0, 0)], ids=[7]), make.tracks([])
    a, b = make.tracks([(1, 0)], ids=[1]), make.tracks([(0, 0)], ids=[2])
    got = run_clear(make, [(one, a), (one, nothing), (one, a), (make.boxes([]), nothing), (one, b)])
    assert got["tracking.id_switches"] == 1
    assert got["tracking.fragmentations"] == 1  # the scan without the object interrupts nothing
    assert got["tracking.mota"] == pytest.approx(1 - 2 / 4)
    assert got["tracking.motp"] == pytest.approx(2 / 3)


def pair_one(make: Any, boxes: Any, tracks: Any, shown: Any = Visibility.VISIBLE, **points: Array) -> Paired:
    xyz = points.pop("xyz", np.zeros((0, 3)))
    frame = make.frame(tracks=tracks, points=xyz, is_ground=np.zeros(len(xyz), bool))
    truth = make.truth(boxes, visibility=shown, **points)
    return Pairer().pair(frame, truth, Returns(frame, truth))


def test_valid_objects_match_first_and_leftovers_at_hidden_ones_are_ignored(make: Any) -> None:
    boxes = make.boxes([(0, 0), (3, 0)])
    shown = [Visibility.VISIBLE, Visibility.HIDDEN]
    paired = pair_one(make, boxes, make.tracks([(1.6, 0), (3.5, 0), (9, 0)]), shown)
    assert paired.partner == {0: 0}
    assert paired.track_id.tolist() == [0, 2]
    assert paired.object_id.tolist() == [0]
    assert paired.ignored == 1


def test_a_moving_object_called_static_is_one_miss(make: Any) -> None:
    moving, parked = make.boxes([(0, 0)]), make.boxes([(0, 0)], velocity=(0.3, 0.3))
    static = make.tracks([(0, 0)], dynamic=False)
    missed = pair_one(make, moving, static)
    assert (len(missed.object_id), len(missed.track_id), len(missed.pairs)) == (1, 0, 0)
    assert missed.called_static == 1
    twice = pair_one(make, moving, make.tracks([(0, 0), (1, 0)], dynamic=[True, False]))
    assert (len(twice.pairs), len(twice.track_id), twice.called_static) == (1, 2, 0)
    assert len(pair_one(make, parked, static).pairs) == 1
    assert len(pair_one(make, parked, make.tracks([(0, 0)])).pairs) == 1


def test_tracks_on_things_are_false_only_if_dynamic(make: Any) -> None:
    xyz = np.array([[20.0, 0, 0], [20.5, 0, 0]])
    tree = {"xyz": xyz, "thing": np.array([3, 3]), "is_ground": np.zeros(2, bool)}
    for dynamic, counted in ((True, 1), (False, 0)):
        tracks = make.tracks([(20, 0)], dynamic=dynamic)
        assert len(pair_one(make, make.boxes([]), tracks, **tree).track_id) == counted
    static = make.tracks([(40, 0)], dynamic=False)
    assert len(pair_one(make, make.boxes([]), static, **tree).track_id) == 1


def test_a_track_keeps_its_thing_while_that_is_out_of_sight(make: Any) -> None:
    pairer, tracks = Pairer(), make.tracks([(20, 0)], dynamic=False)
    xyz = np.array([[20.0, 0, 0]])
    seen = make.frame(tracks=tracks, points=xyz, is_ground=np.zeros(1, bool))
    truth = make.truth(make.boxes([]), thing=np.array([3]), is_ground=np.zeros(1, bool))
    assert pairer.pair(seen, truth, Returns(seen, truth)).ignored == 1
    frame, truth = make.frame(tracks=tracks), make.truth(make.boxes([]))
    assert pairer.pair(frame, truth, Returns(frame, truth)).ignored == 1


def test_only_confirmed_tracks_are_reported(make: Any) -> None:
    paired = pair_one(make, make.boxes([(0, 0)]), make.tracks([(0, 0), (0.1, 0)], status=[4, 6]))
    assert paired.partner == {0: 1}


def test_nothing_to_measure_is_none(make: Any) -> None:
    assert hota([])["hota"] is None
    assert idf1([]) is None
    assert set(TrackingScores().scores().values()) == {None}
    empty = [(make.boxes([]), make.tracks([]))]
    got = run_clear(make, empty)
    assert got["tracking.mota"] is None
    assert got["tracking.id_switches"] is None
