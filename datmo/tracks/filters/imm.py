"""Interacting multiple models (2.44-2.54; method.md section 11).

Arrays over tracks t and modes j: x (t, m, n), P (t, m, n, n), mu (t, m).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numba import njit

from datmo.arrays import F64, Bool
from datmo.tracks.config import TrackerConfig
from datmo.tracks.filters.moments import mixture

TERMS = 24  # of the exponential series at one expected step: the rest is below 1e-23


def rates(config: TrackerConfig) -> F64:
    """Transition rates (m, m) [1/s]: i -> j off the diagonal, rows sum to zero."""
    if config.transition_rates is not None:
        return np.array(config.transition_rates, float)
    m = len(config.models)
    leave = 1 / (config.stay * max(m - 1, 1))
    return np.asarray(np.full((m, m), leave) - np.eye(m) * leave * m)


def transition(rate: F64, dt: float) -> F64:
    """Probability (m, m) of i -> j within `dt` [s]: expm(rate dt)."""
    return _transition(rate.tobytes(), len(rate), dt)


@lru_cache(maxsize=64)
def _transition(rate_bytes: bytes, modes: int, dt: float) -> F64:
    """The matrix, kept for the few steps of time that a sensor has.

    By uniformisation: a Poisson number of steps of the chain I + rate / fastest, all terms
    positive, after halving dt until few steps are expected; squared back.
    """
    rate = np.frombuffer(rate_bytes).reshape(modes, modes)
    fastest = float(-np.diag(rate).min(initial=0))
    if fastest * dt <= 0:
        return np.eye(modes)
    halvings = max(0, int(np.ceil(np.log2(fastest * dt))))
    expected = fastest * dt / 2**halvings
    chain, term = np.eye(modes) + rate / fastest, np.exp(-expected) * np.eye(modes)
    p = term.copy()
    for k in range(1, TERMS):
        term = np.einsum("ij,jk->ik", term, chain) * expected / k
        p += term
    for _ in range(halvings):
        p = np.einsum("ij,jk->ik", p, p)
    return np.asarray(p / p.sum(axis=1, keepdims=True))


def lend(x: F64, P: F64, mu: F64, coordinate: int, has: Bool) -> tuple[F64, F64]:
    """Give models without a yaw rate, or an acceleration, that of the likeliest model that has one.

    Their own stands at zero by construction; averaged in, it would straighten every turn.
    The lent coordinate comes uncorrelated, which keeps P positive definite.

    Args:
        x: (t, m, n). P: (t, m, n, n). mu: (t, m). coordinate: of the state.
        has: (m,) whether it means anything under each model.
    """
    if has.all() or not has.any():
        return x, P
    x, P = x.copy(), P.copy()
    _lend(x, P, mu, coordinate, has)
    return x, P


@njit(cache=True, nogil=True)
def _lend(x, P, mu, k, has):  # type: ignore[no-untyped-def]  # pragma: no cover - compiled
    m, n = len(has), x.shape[2]
    for t in range(len(x)):
        donor = -1
        for j in range(m):
            if has[j] and (donor < 0 or mu[t, j] > mu[t, donor]):
                donor = j
        for j in range(m):
            if not has[j]:
                x[t, j, k] = x[t, donor, k]
                for i in range(n):
                    P[t, j, k, i] = P[t, j, i, k] = 0
                P[t, j, k, k] = P[t, donor, k, k]


def mix(x: F64, P: F64, mu: F64, p: F64) -> tuple[F64, F64, F64]:
    """Interaction (2.44-2.47): states that each filter starts from, and mu_bar (t, m)."""
    mu_bar = np.einsum("ti,ij->tj", mu, p)
    weights = mu[:, :, None] * p[None] / np.maximum(mu_bar, 1e-300)[:, None, :]  # (t, i, j)
    w = np.swapaxes(weights, 1, 2)  # (t, j, i)
    mean, cov = np.empty_like(x), np.empty_like(P)
    for j in range(len(p)):
        own = np.ascontiguousarray(x[:, j])
        mean[:, j], cov[:, j] = mixture(x, P, np.ascontiguousarray(w[:, j]), own)
    return mean, cov, mu_bar


def combine(x: F64, P: F64, mu: F64) -> tuple[F64, F64]:
    """One mean (t, n) and covariance (t, n, n) of all modes, same weights in both (2.53-2.54)."""
    best = x[np.arange(len(x)), np.argmax(mu, axis=1)]
    return mixture(x, P, mu, best)


def reweigh(mu_bar: F64, likelihood: F64) -> F64:
    """Mode probabilities (t, m) after a scan (2.52); never quite zero, so that a mode can return."""
    mu = np.maximum(mu_bar * likelihood, 1e-12 * mu_bar.max(axis=1, keepdims=True, initial=0))
    return np.asarray(mu / mu.sum(axis=1, keepdims=True))
