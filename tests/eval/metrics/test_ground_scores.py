from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.metrics import precision_recall_fscore_support

from datmo.arrays import F64
from datmo.messages import Kind, Surface
from eval.metrics.ground import cell_of, grid_centres, label_counts, label_detail, label_scores
from eval.metrics.height import height_detail, height_scores, heights, join


@dataclass(frozen=True)
class Waves(Surface):
    """Height 0.1 sin(x), off by `bias`, unknown where x > `limit`."""

    bias: float = 0.0
    std: float = 0.1
    limit: float = np.inf

    def __call__(self, xy: F64) -> tuple[F64, F64]:
        z = np.where(xy[:, 0] > self.limit, np.nan, 0.1 * np.sin(xy[:, 0]) + self.bias)
        return z, np.full(len(xy), self.std)


def test_grid_is_fixed_and_each_centre_lies_in_its_own_cell() -> None:
    centres = grid_centres()
    assert centres.shape == (21600, 2)
    np.testing.assert_array_equal(cell_of(centres), np.arange(21600))
    np.testing.assert_array_equal(cell_of(np.array([[0.5, 0.0], [0.0, 81.0]])), [-1, -1])


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_labels_agree_with_scikit_learn(make: Any, seed: int) -> None:
    rng = np.random.default_rng(seed)
    true, called = rng.random(200) < 0.6, rng.random(200) < 0.5
    points = np.column_stack([rng.uniform(-45, 45, (200, 2)), np.zeros(200)])
    points[:, :2] *= np.minimum(1, 49 / np.linalg.norm(points[:, :2], axis=1))[:, None]
    counts = label_counts(
        make.frame(points=points, is_ground=called), make.truth(make.boxes([]), is_ground=true)
    )
    got = label_scores(counts)
    p, r, f, _ = precision_recall_fscore_support(true, called)
    want = {
        "precision": p[1],
        "recall": r[1],
        "f1": f[1],
        "obstacle_precision": p[0],
        "obstacle_recall": r[0],
    }
    for name, value in want.items():
        assert got[f"ground.{name}"] == pytest.approx(value, abs=1e-12)


def test_leak_counts_vehicles_and_persons_within_50_m(make: Any) -> None:
    points = np.array([[5, 0, -1.7], [5, 0, -1], [6, 0, -1], [7, 0, -1], [51, 0, -1], [9, 0, -1]], float)
    truth = make.truth(
        make.boxes([(5, 0), (7, 0)], kind=[Kind.CAR, Kind.PEDESTRIAN], ids=[4, 9]),
        kind=np.array([Kind.CAR, Kind.CAR, Kind.CAR, Kind.PEDESTRIAN, Kind.CAR, Kind.TRUNK]),
        actor=np.array([0, 0, 0, 1, 0, -1]),
        is_ground=np.zeros(6, bool),
    )
    called = np.array([True, False, True, True, True, True])
    counts = label_counts(make.frame(points=points, is_ground=called), truth)
    assert label_scores(counts)["ground.leak"] == pytest.approx(3 / 4)
    detail = label_detail(counts)
    assert detail["leak_above_0.1m"] == pytest.approx(2 / 3)
    assert detail["leak_of_object"] == {"4": pytest.approx(2 / 3), "9": 1.0}
    assert detail["leak_per_object"] == pytest.approx(5 / 6)


def _places(make: Any, surface: Surface, hit: F64, exposed: Any = True, blind: float = 3.0) -> Any:
    xy = grid_centres()
    relief = make.relief(xy, 0.1 * np.sin(xy[:, 0]), exposed)
    points = np.column_stack([hit, np.zeros(len(hit))])
    frame = make.frame(points=points, surface=surface)
    return heights(frame, make.truth(make.boxes([]), is_ground=np.ones(len(hit), bool)), relief, blind)


def test_height_where_seen_and_where_not(make: Any) -> None:
    xy = grid_centres()
    r = np.hypot(*xy.T)
    near = (r > 3) & (r < 30)
    places = _places(make, Waves(bias=0.2), xy[near])
    scores = height_scores(places)
    assert len(places.true) == ((r >= 3) & (r <= 50)).sum()
    assert scores["ground.height_rmse"] == pytest.approx(0.2, rel=1e-5)
    assert scores["ground.height_rmse_unseen"] == pytest.approx(0.2, rel=1e-5)
    variance = np.var(0.1 * np.sin(xy[near, 0]))
    assert scores["ground.smse"] == pytest.approx(0.04 / variance, rel=1e-4)
    assert scores["ground.nlpd"] == pytest.approx(0.5 * np.log(2 * np.pi * 0.01) + 2, rel=1e-4)
    assert scores["ground.coverage95"] == 0.0
    assert height_detail(places)["seen"]["rmse_by_range"]["30-50"] is None


def test_places_without_prediction_cost_a_metre(make: Any) -> None:
    xy = grid_centres()
    places = _places(make, Waves(limit=0.0), xy[np.hypot(*xy.T) < 50])
    missing = float(np.mean(xy[np.hypot(*xy.T) < 50, 0] > 0))
    assert height_scores(places)["ground.height_rmse"] == pytest.approx(np.sqrt(missing), rel=1e-6)
    assert height_scores(places)["ground.coverage95"] == pytest.approx(1 - missing)
    assert height_detail(places)["seen"]["missing_share"] == pytest.approx(missing)


def test_unseen_places_must_be_exposed_and_outside_the_blind_radius(make: Any) -> None:
    none = np.zeros((0, 2))
    assert len(_places(make, Waves(), none, exposed=False).true) == 0
    r = np.hypot(*grid_centres().T)
    assert len(_places(make, Waves(), none, blind=10.0).true) == ((r >= 10) & (r <= 50)).sum()


def test_coverage_of_a_truth_drawn_from_the_prediction(make: Any) -> None:
    rng = np.random.default_rng(5)
    xy = grid_centres()
    r = np.hypot(*xy.T)
    relief = make.relief(xy, 0.1 * np.sin(xy[:, 0]) + rng.normal(0, 0.1, len(xy)))
    points = np.column_stack([xy[r < 50], np.zeros((r < 50).sum())])
    truth = make.truth(make.boxes([]), is_ground=np.ones(len(points), bool))
    scores = height_scores(heights(make.frame(points=points, surface=Waves()), truth, relief, 3.0))
    assert scores["ground.coverage95"] == pytest.approx(0.95, abs=0.01)
    assert scores["ground.nlpd"] == pytest.approx(0.5 * np.log(2 * np.pi * 0.01) + 0.5, abs=0.03)


def test_flat_truth_has_no_smse_and_nothing_has_no_score(make: Any) -> None:
    xy = grid_centres()
    frame, truth = make.frame(points=[[10.0, 0, 0]]), make.truth(make.boxes([]), is_ground=np.ones(1, bool))
    scores = height_scores(heights(frame, truth, make.relief(xy), 3.0))
    assert scores["ground.height_rmse"] == pytest.approx(0, abs=1e-9)
    assert scores["ground.smse"] is None
    assert set(height_scores(join([])).values()) == {None}
    nothing = label_counts(make.frame(), make.truth(make.boxes([])))
    assert set(label_scores(nothing).values()) == {None}
