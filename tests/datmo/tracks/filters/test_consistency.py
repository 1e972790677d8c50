"""Matched noise: the filter's covariance speaks the truth about its error."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2

from datmo.messages import Boxes
from datmo.tracks import Tracker, TrackerConfig
from datmo.tracks.models import make_models

RUNS, SCANS, DT, SETTLED = 100, 100, 0.1, 15
STD, YAW_STD = 0.15, 0.06


def play(name: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """NEES of the place, by two, and NIS, by two, (SCANS - SETTLED, RUNS) each: runs are cars far apart."""
    config = TrackerConfig(
        models=(name,),
        given_std=(STD, STD),
        position_std=STD,
        yaw_std=YAW_STD,
        yaw_accel_density=0.01,  # cars, not tops
        bias_std=0.0,
        unknown_side_std=0.0,
        gate_chi2=25.0,
        gate_prob=0.999999,
        detection_prob=0.999,
        clutter_density=1e-6,
    )
    rng, model, tracker = np.random.default_rng(seed), make_models(config)[0], Tracker(config)
    x = np.zeros((RUNS, 5))
    x[:, 0] = 1000.0 * np.arange(RUNS)
    x[:, 2], x[:, 3] = rng.uniform(-np.pi, np.pi, RUNS), rng.uniform(8, 15, RUNS)
    x[:, 4] = 0.2 if name == "ctrv" else 0.0
    nees, nis = [], []
    for k in range(SCANS):
        if k:
            noise = np.linalg.cholesky(model.noise(x, DT))
            x = model.propagate(x, DT) + np.einsum("nij,nj->ni", noise, rng.normal(0, 1, x.shape))
        seen = x[:, :2] + rng.normal(0, STD, (RUNS, 2))
        boxes = Boxes(
            center=np.column_stack([seen, np.zeros(RUNS)]),
            size=np.tile([4.5, 1.8, 1.5], (RUNS, 1)),
            yaw=x[:, 2] + rng.normal(0, YAW_STD, RUNS),
        )
        tracks = tracker.step(boxes, DT * k)
        if k >= SETTLED:
            assert len(tracks) == RUNS
            order = np.argsort(tracks.boxes.center[:, 0])
            error = tracks.boxes.center[order, :2] - x[np.argsort(x[:, 0]), :2]
            solved = np.linalg.solve(tracks.cov[order, :2, :2], error[..., None])[..., 0]
            nees.append(np.sum(error * solved, axis=1) / 2)
            nis.append([tracker.nis[int(i)][0] / 2 for i in tracks.boxes.id[order]])
    return np.array(nees), np.array(nis)


@pytest.mark.parametrize("name", ["cv", "ctrv"])
def test_errors_are_as_large_as_the_covariance_says(name):
    nees, nis = play(name, seed=1)
    assert 0.9 <= nees.mean() <= 1.1
    low, high = chi2.ppf([0.025, 0.975], 2 * RUNS) / (2 * RUNS)
    inside = (nis.mean(axis=1) >= low) & (nis.mean(axis=1) <= high)
    assert inside.mean() >= 0.9
