"""On a linear model every filter is the Kalman filter."""

from __future__ import annotations

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter

from datmo.messages import Boxes
from datmo.tracks.config import TrackerConfig
from datmo.tracks.filters.engine_filterpy import FilterpyFilters
from datmo.tracks.filters.imm import combine, mix, rates, transition
from datmo.tracks.filters.ukf import BatchedFilters
from datmo.tracks.management.birth import Newborns
from datmo.tracks.measurement.measured import measured
from datmo.tracks.models import make_models

MODELS = make_models(TrackerConfig())


def random_states(rng, n, spread=1.0):
    x = np.column_stack(
        [
            rng.uniform(-50, 50, (n, 2)),
            rng.uniform(-1, 1, n),
            rng.uniform(-3, 12, n),
            rng.uniform(-0.5, 0.5, n),
        ]
    )
    A = rng.normal(0, 1, (n, 5, 5)) * np.array([0.4, 0.4, 0.08, 0.6, 0.1])[:, None] * spread
    return x, np.einsum("nij,nkj->nik", A, A) + 1e-4 * np.eye(5)


def test_linear_motion_equals_the_kalman_filter():
    """RM is linear, and so is the measurement: nothing is left to the sigma points."""
    model = MODELS[2]
    rng = np.random.default_rng(1)
    x, P = random_states(rng, 1)
    kf = KalmanFilter(5, 2)
    kf.x, kf.P, kf.H = x[0].copy(), P[0].copy(), np.eye(2, 5)
    kf.Q, kf.R = model.noise(x, 0.1)[0], 0.04 * np.eye(2)
    for _ in range(20):
        z = rng.normal(0, 1, (1, 2)) + x[0, :2]
        x, P = BatchedFilters().predict(model, x, P, 0.1)
        x, P = BatchedFilters().correct(x, P, z, 0.04 * np.eye(2)[None], np.array([np.nan]), np.ones(1))
        kf.predict()
        kf.update(z[0])
    np.testing.assert_allclose(x[0], kf.x, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(P[0], kf.P, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("filters", [BatchedFilters(), FilterpyFilters()], ids=["batched", "filterpy"])
def test_every_filter_is_the_kalman_filter_where_cv_is_linear(filters):
    """A heading that is known leaves CV linear in place and speed along it."""
    rng, T = np.random.default_rng(7), 0.1
    for psi in (0.0, 0.7, -2.0):
        A = rng.normal(0, 0.5, (3, 3))
        x, P = np.array([[3.0, -2.0, psi, 8.0, 0.0]]), 1e-16 * np.eye(5)[None]
        P[0][np.ix_([0, 1, 3], [0, 1, 3])] += A @ A.T
        Q = MODELS[0].noise(x, T)[0]
        kf = KalmanFilter(5, 2)
        kf.F[0, 3], kf.F[1, 3], kf.F[4, 4] = T * np.cos(psi), T * np.sin(psi), 0
        kf.x, kf.P, kf.H, kf.Q, kf.R = x[0].copy(), P[0].copy(), np.eye(2, 5), Q, 0.04 * np.eye(2)
        z = np.array([4.0, -1.5])
        x, P = filters.predict(MODELS[0], x, P, T)
        kf.predict()
        np.testing.assert_allclose(x[0], kf.x, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(P[0], kf.P, rtol=1e-9, atol=1e-9)
        x, P = filters.correct(x, P, z[None], kf.R[None], np.array([np.nan]), np.ones(1))
        kf.update(z)
        np.testing.assert_allclose(x[0], kf.x, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(P[0], kf.P, rtol=1e-9, atol=1e-9)


def test_an_imm_of_one_linear_model_thrice_is_the_kalman_filter():
    config, model = TrackerConfig(), MODELS[2]
    rng = np.random.default_rng(8)
    x0, P0 = random_states(rng, 1)
    kf = KalmanFilter(5, 2)
    kf.x, kf.P, kf.H = x0[0].copy(), P0[0].copy(), np.eye(2, 5)
    kf.Q, kf.R = model.noise(x0, 0.1)[0], 0.04 * np.eye(2)
    x, P, mu = np.repeat(x0[:, None], 3, 1), np.repeat(P0[:, None], 3, 1), np.array([[0.6, 0.3, 0.1]])
    for _ in range(20):
        z = rng.normal(0, 1, (1, 2)) + x0[0, :2]
        x, P, mu = mix(x, P, mu, transition(rates(config), 0.1))
        for j in range(3):
            x[:, j], P[:, j] = BatchedFilters().predict(model, x[:, j], P[:, j], 0.1)
            x[:, j], P[:, j] = BatchedFilters().correct(
                x[:, j], P[:, j], z, kf.R[None], np.array([np.nan]), np.ones(1)
            )
        kf.predict()
        kf.update(z[0])
    mean, cov = combine(x, P, mu)
    np.testing.assert_allclose(mean[0], kf.x, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(cov[0], kf.P, rtol=1e-9, atol=1e-9)


def test_new_tracks_are_filtered_by_the_kalman_filter():
    config, rng = TrackerConfig(), np.random.default_rng(9)
    one = Boxes([[1.0, 2, 0]], [[4.5, 1.8, 1.5]], [0.0])
    new, T = Newborns.start(np.array([1]), 0.0, measured(one, False, config), config), 0.1
    kf = KalmanFilter(4, 2)
    kf.x, kf.P, kf.H, kf.R = (
        new.x[0].copy(),
        new.P[0].copy(),
        np.eye(2, 4),
        config.position_std**2 * np.eye(2),
    )
    kf.F[0, 2] = kf.F[1, 3] = T
    kf.Q = 2 * config.accel_density * np.kron([[T**3 / 3, T**2 / 2], [T**2 / 2, T]], np.eye(2))
    for k in range(10):
        place = np.array([1 + 0.8 * k, 2 - 0.3 * k, 0]) + rng.normal(0, 0.1, 3)
        new.predict(T, config)
        given = measured(Boxes(place[None], one.size, one.yaw), False, config)
        new.correct(np.array([0]), given, None, config)
        kf.predict()
        kf.update(place[:2])
    np.testing.assert_allclose(new.x[0], kf.x, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(new.P[0], kf.P, rtol=1e-9, atol=1e-9)
