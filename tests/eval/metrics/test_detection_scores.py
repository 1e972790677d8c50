from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment
from shapely import affinity
from shapely.geometry import box as rectangle

from datmo.arrays import Array
from datmo.messages import Boxes, Frame, Kind, Truth, Visibility
from eval.metrics.detection import DetectionScores, match_detections
from eval.metrics.matching import Returns, assign, gates
from eval.metrics.occlusion import OcclusionScores


def score(frame: Frame, truth: Truth) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    matched = match_detections(frame, truth, Returns(frame, truth))
    detection, occlusion = DetectionScores(), OcclusionScores()
    detection.add(frame, truth, matched)
    occlusion.add(truth, matched)
    return detection.scores(), detection.detail(), occlusion.scores()


def test_gates_by_kind(make: Any) -> None:
    kinds = [Kind.CAR, Kind.TRUCK, Kind.PEDESTRIAN]
    np.testing.assert_array_equal(gates(make.boxes(np.zeros((3, 2)), kind=kinds)), [2.0, 5.0, 1.0])


def test_assignment_takes_most_pairs_then_least_cost() -> None:
    cost = np.array([[0.0, 1.9], [1.9, 9.0]])
    row, column = assign(cost, cost <= 2)
    assert list(zip(row, column, strict=True)) == [(0, 1), (1, 0)]
    assert len(assign(cost, np.zeros((2, 2), bool))[0]) == 0
    rng = np.random.default_rng(1)
    cost = rng.random((6, 4))
    np.testing.assert_array_equal(assign(cost, np.ones((6, 4), bool))[0], linear_sum_assignment(cost)[0])


def test_counts_errors_and_nulls(make: Any) -> None:
    truth = make.truth(
        make.boxes(
            [(10, 0), (20, 0), (45, 0), (30, 0)], kind=[Kind.CAR, Kind.PEDESTRIAN, Kind.TRUCK, Kind.CAR]
        ),
        returns=[50, 50, 50, 4],
    )
    boxes = make.boxes([(11, 0), (21.5, 0), (45, 3), (31, 0)], yaw=[0.1, 0, np.pi + 0.3, 0])
    scores, detail, _ = score(make.frame(boxes=boxes), truth)
    assert scores["detection.precision"] == pytest.approx(2 / 3)  # the fourth is near a poor object
    assert scores["detection.recall"] == pytest.approx(2 / 3)
    assert scores["detection.recall_vehicles_40m"] == 1.0
    assert scores["detection.center_error"] == pytest.approx(2.0)
    assert scores["detection.yaw_error"] == pytest.approx(0.2)
    assert (detail["ignored"], detail["false"], detail["clutter"]) == (1, 1, 0)
    scores, _, occlusion = score(make.frame(), make.truth(make.boxes([])))
    assert set(scores.values()) == set(occlusion.values()) == {None}


def outline(boxes: Boxes, i: int) -> Any:
    x, y = boxes.size[i, :2] / 2
    turned = affinity.rotate(rectangle(-x, -y, x, y), boxes.yaw[i], origin=(0, 0), use_radians=True)
    return affinity.translate(turned, *boxes.center[i, :2])


def test_overlap_agrees_with_shapely(make: Any) -> None:
    rng = np.random.default_rng(2)
    true = make.boxes(np.arange(5)[:, None] * [20.0, 0.0], yaw=rng.uniform(-3, 3, 5))
    found = make.boxes(true.center[:, :2] + rng.normal(0, 0.5, (5, 2)), yaw=rng.uniform(-3, 3, 5))
    scores, _, _ = score(make.frame(boxes=found), make.truth(true))
    a, b = [outline(found, i) for i in range(5)], [outline(true, i) for i in range(5)]
    want = np.mean([p.intersection(q).area / p.union(q).area for p, q in zip(a, b, strict=True)])
    assert scores["detection.iou"] == pytest.approx(want, abs=1e-9)


def test_nearest_visible_corner(make: Any) -> None:
    true = make.boxes([(10, 5)])
    short = Boxes(center=[[9.0, 5.0, 0]], size=[[2.0, 1.8, 1.5]], yaw=[np.pi])
    _, detail, _ = score(make.frame(boxes=short), make.truth(true))
    assert detail["corner_error"]["mean"] == pytest.approx(0, abs=1e-12)
    assert detail["center_error"]["mean"] == pytest.approx(1.0)


def test_what_is_made_of_things_is_clutter(make: Any) -> None:
    around: Array = np.array([[0.0, 0], [0.3, 0.2], [-0.3, 0.1]])
    points = np.concatenate([around + c for c in ([20, 20], [30, 0], [30, 30])])
    points = np.column_stack([points, np.zeros(9)])
    thing = np.array([5, 5, -1, 5, -1, -1, 7, 7, 7])
    truth = make.truth(make.boxes([]), thing=thing, is_ground=np.zeros(9, bool))
    called = np.array([False] * 6 + [True] * 3)
    frame = make.frame(boxes=make.boxes([(20, 20), (30, 0), (30, 30)]), points=points, is_ground=called)
    scores, detail, _ = score(frame, truth)
    assert (detail["clutter"], detail["false"]) == (1, 2)
    assert scores["detection.precision"] == 0.0
    assert scores["detection.recall"] is None


def test_recall_by_visibility(make: Any) -> None:
    shown = [Visibility.VISIBLE, Visibility.VISIBLE, Visibility.PARTIAL, Visibility.HEAVY]
    truth = make.truth(make.boxes(np.arange(4)[:, None] * [10.0, 0]), visibility=shown, returns=[9, 9, 9, 4])
    _, _, occlusion = score(make.frame(boxes=make.boxes([(0, 0), (20, 0)])), truth)
    assert occlusion == {
        "occlusion.recall_visible": 0.5,
        "occlusion.recall_partial": 1.0,
        "occlusion.recall_heavy": None,
    }
