from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from eval.metrics.consistency import ConsistencyScores, nees
from eval.metrics.matching import Returns
from eval.metrics.pairing import Pairer


def add(scores: ConsistencyScores, make: Any, boxes: Any, tracks: Any, fed: Any = (), nis: Any = ()) -> None:
    frame, truth = make.frame(tracks=tracks), make.truth(boxes)
    paired = Pairer().pair(frame, truth, Returns(frame, truth))
    scores.add(frame, truth, paired, dict(fed), dict(nis))


def test_nees_is_the_squared_error_by_its_covariance() -> None:
    rng = np.random.default_rng(3)
    A = rng.normal(size=(50, 4, 4))
    cov, error = A @ A.transpose(0, 2, 1) + 0.1 * np.eye(4), rng.normal(size=(50, 4))
    want = [e @ np.linalg.inv(P) @ e / 4 for e, P in zip(error, cov, strict=True)]
    np.testing.assert_allclose(nees(error, cov), want, rtol=1e-9)
    assert np.isnan(nees(np.ones((1, 2)), np.zeros((1, 2, 2)))).all()


def test_a_consistent_filter_scores_one(make: Any) -> None:
    rng = np.random.default_rng(4)
    scores = ConsistencyScores()
    std = np.array([0.8, 0.5, 0.1, 0.6, 1.0])
    truth = np.arange(40)[:, None] * [50.0, 0.0]
    for _ in range(60):
        error = rng.normal(size=(40, 4)) * std[:4]
        yaw, speed = error[:, 2], 10 + error[:, 3]
        flip = rng.random(40) < 0.5  # the same motion told the other way round
        velocity = speed[:, None] * np.column_stack([np.cos(yaw), np.sin(yaw)])
        tracks = make.tracks(
            truth + error[:, :2], yaw=yaw + np.pi * flip, velocity=velocity, cov=np.diag(std**2)
        )
        add(scores, make, make.boxes(truth), tracks)
    detail = scores.detail([])
    assert detail["nees"]["count"] > 2390  # the gate lets 999 of 1000 through
    assert scores.scores()["consistency.nees"] == pytest.approx(1, abs=0.06)
    assert detail["nees_full_state"]["mean"] == pytest.approx(1, abs=0.06)


def test_the_filters_own_gate_is_not_tightened(make: Any) -> None:
    far = make.tracks([(3.0, 0)], cov=4.0 * np.eye(5))  # beyond d0 / 2, within 3.7 sigma
    scores = ConsistencyScores()
    add(scores, make, make.boxes([(0, 0)]), far)
    assert scores.scores()["consistency.nees"] == pytest.approx(9 / 4 / 2)
    scores = ConsistencyScores()
    add(scores, make, make.boxes([(0, 0)]), make.tracks([(3.0, 0)], cov=0.1 * np.eye(5)))
    assert scores.scores()["consistency.nees"] is None
    scores = ConsistencyScores()  # matched, however sure the filter is
    add(scores, make, make.boxes([(0, 0)]), make.tracks([(1.9, 0)], cov=0.01 * np.eye(5)))
    assert scores.scores()["consistency.nees"] == pytest.approx(1.9**2 / 0.01 / 2)


def test_nis_counts_true_measurements_only(make: Any) -> None:
    scores = ConsistencyScores()
    boxes, tracks = make.boxes([(0, 0), (50, 0)]), make.tracks([(0, 0), (50, 0), (90, 0)], ids=[10, 11, 12])
    add(scores, make, boxes, tracks, fed={10: 0, 11: 0, 12: 1}, nis={10: 3.0, 11: 8.0, 12: 9.0})
    add(scores, make, boxes, tracks, fed={10: 0}, nis={10: np.nan})
    assert scores.scores()["consistency.nis"] == pytest.approx(1.5)
