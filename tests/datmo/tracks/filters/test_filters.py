"""UKF, models and IMM against filterpy and a scalar reference."""

from __future__ import annotations

import numpy as np
import pytest
from filterpy.kalman import IMMEstimator, MerweScaledSigmaPoints, UnscentedKalmanFilter
from scipy.linalg import expm

from datmo.geometry import wrap_angle
from datmo.tracks.config import TrackerConfig
from datmo.tracks.filters.engine_filterpy import FilterpyFilters, residual
from datmo.tracks.filters.imm import combine, lend, mix, rates, reweigh, transition
from datmo.tracks.filters.ukf import BatchedFilters, square_root
from datmo.tracks.models import make_models

NAMES = ("cv", "ctrv", "rm", "ctra", "csav", "cca")
ALL = make_models(TrackerConfig(models=NAMES))
MODELS = ALL[:3]


def random_states(rng, n, spread=1.0, size=5):
    x = np.column_stack(
        [
            rng.uniform(-50, 50, (n, 2)),
            rng.uniform(-1, 1, n),
            rng.uniform(-3, 12, n),
            rng.uniform(-0.5, 0.5, n),
        ]
    )
    x = np.column_stack([x, rng.uniform(-3, 3, n)])[:, :size]
    A = rng.normal(0, 1, (n, size, size)) * np.array([0.4, 0.4, 0.08, 0.6, 0.1, 0.5])[:size, None] * spread
    return x, np.einsum("nij,nkj->nik", A, A) + 1e-4 * np.eye(size)


def scalar_predict(model, x, P, dt):
    """One state, one sigma point after another; plain sums, the yaw far from +-pi."""
    n = len(x)
    C = square_root(n * P[None])[0][0]
    points = [x, *(x + C[:, i] for i in range(n)), *(x - C[:, i] for i in range(n))]
    moved = [model.propagate(p[None], dt)[0] for p in points]
    mean = sum(p / (2 * n) for p in moved[1:])
    cov = 2 * np.outer(moved[0] - mean, moved[0] - mean)
    for p in moved[1:]:
        cov = cov + np.outer(p - mean, p - mean) / (2 * n)
    return mean, cov + model.noise(x[None], dt)[0]


@pytest.mark.parametrize(
    ("model", "size"), [(m, n) for m in ALL for n in (5, 6) if n == 6 or not m.has_acceleration]
)
def test_batched_equals_scalar_and_filterpy(model, size):
    rng = np.random.default_rng(0)
    x, P = random_states(rng, 20, size=size)
    z, R = x[:, :2] + rng.normal(0, 0.5, (20, 2)), np.tile([[0.04, 0.01], [0.01, 0.09]], (20, 1, 1))
    yaw = np.where(np.arange(20) % 3 == 0, np.nan, x[:, 2] + 0.05)
    var = np.full(20, 0.004)
    for i in range(20):
        mean, cov = scalar_predict(model, x[i], P[i], 0.1)
        one = BatchedFilters().predict(model, x[i : i + 1], P[i : i + 1], 0.1)
        np.testing.assert_allclose(one[0][0], mean, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(one[1][0], cov, rtol=1e-9, atol=1e-9)
    a = BatchedFilters().predict(model, x, P, 0.1)
    b = FilterpyFilters().predict(model, x, P, 0.1)
    for left, right in zip(a, b, strict=True):
        np.testing.assert_allclose(left, right, rtol=1e-9, atol=1e-9)
    a = BatchedFilters().correct(*a, z, R, yaw, var)
    b = FilterpyFilters().correct(*b, z, R, yaw, var)
    for left, right in zip(a, b, strict=True):
        np.testing.assert_allclose(left, right, rtol=1e-9, atol=1e-9)


def scalar_correct(x, P, z, R, yaw, var):
    """One state, sigma points redrawn and sent through the measurement, plain sums (2.36-2.43)."""
    q = 3 if np.isfinite(yaw) else 2
    C = square_root(5 * P[None])[0][0]
    points = np.array([x, *(x + C[:, i] for i in range(5)), *(x - C[:, i] for i in range(5))])
    weights, noise = np.array([2.0] + [0.1] * 10), np.zeros((q, q))
    noise[:2, :2] = R
    if q == 3:
        noise[2, 2] = var
    seen = points[:, :q]
    mean = 0.1 * seen[1:].sum(0)
    P_z, P_xz = noise, np.zeros((5, q))
    for w, point, s in zip(weights, points, seen, strict=True):
        P_z = P_z + w * np.outer(s - mean, s - mean)
        P_xz = P_xz + w * np.outer(point - x, s - mean)
    K = P_xz @ np.linalg.inv(P_z)
    return x + K @ (np.array([*z, yaw])[:q] - mean), P - K @ P_z @ K.T


def test_correct_equals_a_scalar_unscented_update():
    rng = np.random.default_rng(6)
    x, P = random_states(rng, 20)
    z, R = x[:, :2] + rng.normal(0, 0.5, (20, 2)), np.tile([[0.04, 0.01], [0.01, 0.09]], (20, 1, 1))
    yaw = np.where(np.arange(20) % 3 == 0, np.nan, x[:, 2] + 0.05)
    got = BatchedFilters().correct(x, P, z, R, yaw, np.full(20, 0.004))
    for i in range(20):
        mean, cov = scalar_correct(x[i], P[i], z[i], R[i], yaw[i], 0.004)
        np.testing.assert_allclose(got[0][i], mean, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(got[1][i], cov, rtol=1e-9, atol=1e-9)


def test_mixing_and_combining_equal_plain_sums_with_an_asymmetric_matrix():
    """(2.44-2.47) and (2.53-2.54) written out, one track, the yaw far from +-pi."""
    rng = np.random.default_rng(10)
    p = np.array([[0.9, 0.07, 0.03], [0.2, 0.75, 0.05], [0.3, 0.1, 0.6]])
    x, P = random_states(rng, 12)
    x, P, mu = x.reshape(4, 3, 5), P.reshape(4, 3, 5, 5), rng.dirichlet(np.ones(3), 4)
    got = mix(x, P, mu, p)
    mean, cov = combine(x, P, mu)
    for t in range(4):
        for j in range(3):
            mu_bar = sum(p[i, j] * mu[t, i] for i in range(3))
            w = [p[i, j] * mu[t, i] / mu_bar for i in range(3)]
            m = sum(w[i] * x[t, i] for i in range(3))
            c = sum(w[i] * (P[t, i] + np.outer(x[t, i] - m, x[t, i] - m)) for i in range(3))
            assert got[2][t, j] == pytest.approx(mu_bar, rel=1e-12)
            np.testing.assert_allclose(got[0][t, j], m, rtol=1e-9, atol=1e-9)
            np.testing.assert_allclose(got[1][t, j], c, rtol=1e-9, atol=1e-9)
        m = sum(mu[t, i] * x[t, i] for i in range(3))
        c = sum(mu[t, i] * (P[t, i] + np.outer(x[t, i] - m, x[t, i] - m)) for i in range(3))
        np.testing.assert_allclose(mean[t], m, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(cov[t], c, rtol=1e-9, atol=1e-9)


def test_imm_equals_filterpys_with_an_asymmetric_matrix():
    """Textbook mixing, small yaw spread; filterpy averages the yaw linearly."""
    rng = np.random.default_rng(2)
    p = np.array([[0.9, 0.07, 0.03], [0.2, 0.75, 0.05], [0.3, 0.1, 0.6]])
    x0, P0 = random_states(rng, 1, spread=0.5)
    x, P = np.repeat(x0[:, None], 3, 1), np.repeat(P0[:, None], 3, 1)
    x = x + rng.normal(0, 0.05, x.shape)
    mu, R = np.array([[0.5, 0.3, 0.2]]), 0.04 * np.eye(2)
    filters = []
    for j, model in enumerate(MODELS):
        points = MerweScaledSigmaPoints(5, 1, 2, 0, sqrt_method=lambda A: square_root(A[None])[0][0].T)
        ukf = UnscentedKalmanFilter(5, 2, 0.1, hx=lambda s: s[:2], fx=None, points=points)
        ukf.fx = lambda s, dt, model=model: model.propagate(s, dt)
        ukf.x, ukf.P, ukf.R = x[0, j].copy(), P[0, j].copy(), R
        filters.append(ukf)
    imm = IMMEstimator(filters, mu[0], p)
    for _ in range(5):
        for j, model in enumerate(MODELS):
            mixed = sum(imm.omega[i, j] * filters[i].x for i in range(3))
            filters[j].Q = model.noise(mixed, 0.1)
        z = x0[0, :2] + rng.normal(0, 0.3, 2)
        imm.predict()
        imm.update(z)
        x, P, mu = mix(x, P, mu, p)
        ratio = np.zeros((1, 3))
        for j, model in enumerate(MODELS):
            x[:, j], P[:, j] = BatchedFilters().predict(model, x[:, j], P[:, j], 0.1)
            S, nu = P[0, j, :2, :2] + R, z - x[0, j, :2]
            ratio[0, j] = np.exp(-0.5 * nu @ np.linalg.inv(S) @ nu) / np.sqrt(np.linalg.det(2 * np.pi * S))
            x[:, j], P[:, j] = BatchedFilters().correct(
                x[:, j], P[:, j], z[None], R[None], np.array([np.nan]), np.ones(1)
            )
        mu = reweigh(mu, ratio)
        mean, cov = combine(x, P, mu)
        np.testing.assert_allclose(mu[0], imm.mu, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(mean[0], imm.x, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(cov[0], imm.P, rtol=1e-9, atol=1e-9)


def test_yaw_is_averaged_on_the_circle():
    """Turned by anything, mixing and combining give the turned result, across +-pi too."""
    rng = np.random.default_rng(3)
    x, P = random_states(rng, 3)
    x, P = np.repeat(x[:, None], 3, 1) + rng.normal(0, 0.1, (3, 3, 5)), np.repeat(P[:, None], 3, 1)
    mu, p = rng.dirichlet(np.ones(3), 3), transition(rates(TrackerConfig()), 0.3)
    plain = combine(*mix(x, P, mu, p)[:2], mu)
    for turn in (np.pi - 0.3, 3.0, -2.9):
        turned = x.copy()
        turned[..., 2] = wrap_angle(turned[..., 2] + turn)
        got = combine(*mix(turned, P, mu, p)[:2], mu)
        back = got[0].copy()
        back[:, 2] -= turn
        np.testing.assert_allclose(residual(back, plain[0]), 0, atol=1e-12)
        np.testing.assert_allclose(got[1], plain[1], atol=1e-12)


def test_transition_is_the_exponential_of_the_rates():
    rate = np.array([[-0.7, 0.5, 0.2], [0.1, -0.3, 0.2], [2.0, 1.0, -3.0]])
    for dt in (1e-3, 0.1, 5.0):
        np.testing.assert_allclose(transition(rate, dt), expm(rate * dt), atol=1e-12)
    config = TrackerConfig(stay=2.0)
    assert np.diag(rates(config)).tolist() == [-0.5] * 3
    np.testing.assert_allclose(
        transition(rates(config), 0.2), np.linalg.matrix_power(transition(rates(config), 0.1), 2)
    )


def test_yaw_rate_is_lent_not_averaged():
    x = np.zeros((1, 3, 5))
    x[0, 1, 4] = 0.4
    P = np.tile(np.eye(5), (1, 3, 1, 1))
    P[0, 1, 4, 4] = 0.01
    x, P = lend(x, P, np.full((1, 3), 1 / 3), 4, np.array([False, True, False]))
    mean, cov = combine(x, P, np.full((1, 3), 1 / 3))
    assert mean[0, 4] == pytest.approx(0.4)
    assert cov[0, 4, 4] == pytest.approx(0.01)


def test_a_broken_covariance_is_repaired_and_counted():
    filters = BatchedFilters()
    P = np.diag([1.0, 1, 1, 1, -1e-12])[None]
    x, out = filters.predict(MODELS[0], np.zeros((1, 5)), P, 0.1)
    assert filters.jitters == 1
    assert np.linalg.eigvalsh(out[0]).min() > 0
    assert np.isfinite(x).all()


def test_the_square_root_is_one():
    _, P = random_states(np.random.default_rng(4), 10)
    C, repaired = square_root(P)
    assert repaired == 0
    np.testing.assert_allclose(np.einsum("nij,nkj->nik", C, C), P, atol=1e-12)
