from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

from datmo.ground.gp import correlation, expect, grow, regress


def kernel(ra: np.ndarray, rb: np.ndarray, La: np.ndarray, Lb: np.ndarray) -> np.ndarray:
    """(3.16) as printed, dense, σ_f = 1."""
    S = La[:, None] ** 2 + Lb[None] ** 2
    d = ra[:, None] - rb[None]
    return (La[:, None] ** 2) ** 0.25 * (Lb[None] ** 2) ** 0.25 * (S / 2) ** -0.5 * np.exp(-2 * d**2 / S)


def ours(ra: np.ndarray, rb: np.ndarray, La: np.ndarray, Lb: np.ndarray) -> np.ndarray:
    return np.array(
        [[correlation(a, b, s, t) for b, t in zip(rb, Lb, strict=True)] for a, s in zip(ra, La, strict=True)]
    )


def data(seed: int = 0, n: int = 25) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    r = np.sort(rng.uniform(3, 50, n))
    return r, np.sin(r / 5 + seed) * 0.1, rng.uniform(0.01, 0.05, n) ** 2, rng.uniform(1, 8, n)


def test_kernel_is_the_printed_one() -> None:
    r, _, _, L = data()
    # Correlations below exp(-20) are cut to 0.
    assert np.allclose(ours(r, r, L, L), kernel(r, r, L, L), atol=3e-9)


def test_equal_lengths_give_a_squared_exponential_of_length_over_root_two() -> None:
    r = np.linspace(0, 20, 15)
    L = np.full(15, 3.0)
    usual = RBF(3.0 / np.sqrt(2))(r[:, None])
    assert np.allclose(ours(r, r, L, L), usual, atol=3e-9)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000))
def test_kernel_is_positive_definite_for_any_lengths(seed: int) -> None:
    rng = np.random.default_rng(seed)
    r, L = rng.uniform(0, 80, 40), np.exp(rng.uniform(-3, 4, 40))
    assert np.linalg.eigvalsh(ours(r, r, L, L)).min() > -1e-8


def test_prediction_is_the_textbook_one() -> None:
    r, y, noise, L = data()
    rq, Lq = np.linspace(0, 60, 40), np.linspace(1, 6, 40)
    mean, var, square, log_det = regress(r, y, noise, L, rq, Lq, 0.04)
    A = 0.04 * kernel(r, r, L, L) + np.diag(noise)
    Ks = 0.04 * kernel(r, rq, L, Lq)
    assert np.allclose(mean, Ks.T @ np.linalg.solve(A, y), atol=1e-7)
    assert np.allclose(var, 0.04 - np.sum(Ks * np.linalg.solve(A, Ks), 0), atol=1e-7)
    assert square == pytest.approx(y @ np.linalg.solve(A, y), rel=1e-6)
    assert log_det == pytest.approx(np.linalg.slogdet(A)[1], rel=1e-8)


def test_prediction_and_evidence_are_scikit_learns_when_stationary() -> None:
    r, y, _, _ = data(1)
    L = np.full(len(r), 4.0)
    model = GaussianProcessRegressor(ConstantKernel(0.09) * RBF(4.0 / np.sqrt(2)), alpha=1e-3, optimizer=None)
    model.fit(r[:, None], y)
    rq = np.linspace(0, 70, 30)
    mean, std = model.predict(rq[:, None], return_std=True)
    m, v, square, log_det = regress(r, y, np.full(len(r), 1e-3), L, rq, np.full(30, 4.0), 0.09)
    assert np.allclose(m, mean, atol=1e-6)
    assert np.allclose(np.sqrt(v), std, atol=1e-6)
    likelihood = -0.5 * (square + log_det + len(r) * np.log(2 * np.pi))
    assert likelihood == pytest.approx(model.log_marginal_likelihood_value_, rel=1e-6)


def test_the_mean_alone_is_the_same_mean() -> None:
    r, y, noise, L = data(2)
    rq, Lq = np.linspace(0, 60, 40), np.linspace(1, 6, 40)
    mean = regress(r, y, noise, L, rq, Lq, 0.04)[0]
    assert np.allclose(expect(r, y, noise, L, rq, Lq, 0.04), mean, atol=1e-9)


def test_nothing_seen_is_the_prior() -> None:
    none, rq = np.empty(0), np.linspace(0, 60, 4)
    mean, var, _, _ = regress(none, none, none, none, rq, np.ones(4), 0.04)
    assert np.array_equal(mean, np.zeros(4))
    assert np.array_equal(var, np.full(4, 0.04))
    assert np.array_equal(expect(none, none, none, none, rq, np.ones(4), 0.04), np.zeros(4))


def plain_growth(r, y, L, noise, seed, above, sf2, most_var, most_distance):  # type: ignore[no-untyped-def]
    """Alg. 2 with a dense solve in every round."""
    member, joins, D = np.zeros(len(r), bool), seed.copy(), noise.copy()
    mean = np.zeros(len(r))
    while joins.any():
        D[joins] = noise[joins] + (above * np.maximum(y - mean, 0)[joins]) ** 2
        member |= joins
        K = sf2 * kernel(r, r[member], L, L[member])
        A = K[member] + np.diag(D[member])
        mean = K @ np.linalg.solve(A, y[member])
        var = sf2 - np.sum(K * np.linalg.solve(A, K.T).T, 1)
        near = np.abs(y - mean) <= most_distance * np.sqrt(noise + var)
        joins = ~member & (var <= most_var) & near
    return member, mean


@pytest.mark.parametrize("above", [0.0, 2.0])
def test_growth_is_algorithm_2(above: float) -> None:
    sizes = []
    for k in range(8):
        r, y, noise, L = data(k, 40)
        y[np.random.default_rng(k).random(40) < 0.2] += 0.6  # obstacles
        seed = (np.abs(y) < 0.15) & (r < 12)
        ours, mean = grow(r, y, L, noise, seed, above, np.array([0.02, 0.012, 3.0]))
        member, level = plain_growth(r, y, L, noise, seed, above, 0.02, 0.012, 3.0)
        assert np.array_equal(ours, member)
        assert np.allclose(mean, level, atol=1e-6)
        sizes.append((seed.sum(), ours.sum()))
    assert sum(b > a for a, b in sizes) >= 4  # it did grow
    assert max(b for _, b in sizes) < 40


def test_nothing_grows_without_seeds() -> None:
    r, y, noise, L = data()
    assert not grow(r, y, L, noise, np.zeros(25, bool), 2.0, np.array([0.02, 1.0, 3.0]))[0].any()
