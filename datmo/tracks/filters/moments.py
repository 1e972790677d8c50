"""Means and covariances of weighted states, compiled: what the filters and the IMM are made of.

The yaw is averaged as differences from a reference, which equals the linear mean away from +-pi and does
not depend on where the circle is cut.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F64, Bool
from datmo.tracks.models import PSI

MAX_STD = np.array([np.inf, np.inf, 1.0, 30.0, 1.5, 10.0])  # beyond these a deviation means nothing


@njit(cache=True, nogil=True, error_model="numpy")
def wrapped(angle: float) -> float:  # pragma: no cover - compiled
    """`geometry.wrap_angle` of one angle [rad]."""
    return (angle + np.pi) % (2 * np.pi) - np.pi


@njit(cache=True, nogil=True, error_model="numpy")
def _mean_about(x, weight, reference, out):  # type: ignore[no-untyped-def]  # pragma: no cover - compiled
    """Weighted mean (n,) of states (m, n) about `reference` (n,)."""
    m, n = x.shape
    for i in range(n):
        total = 0.0
        for j in range(m):
            d = x[j, i] - reference[i]
            total += weight[j] * (wrapped(d) if i == PSI else d)
        out[i] = reference[i] + total
    out[PSI] = wrapped(out[PSI])


@njit(cache=True, nogil=True, error_model="numpy")
def _spread(x, weight, mean, out):  # type: ignore[no-untyped-def]  # pragma: no cover - compiled
    """Add the weighted products of the states' (m, n) distances from `mean` (n,) to `out` (n, n)."""
    m, n = x.shape
    d = np.empty(n)
    for j in range(m):
        for i in range(n):
            d[i] = x[j, i] - mean[i]
        d[PSI] = wrapped(d[PSI])
        for i in range(n):
            for k in range(n):
                out[i, k] += weight[j] * d[i] * d[k]


@njit(cache=True, nogil=True, error_model="numpy")
def mixture(x: F64, P: F64, weight: F64, reference: F64) -> tuple[F64, F64]:  # pragma: no cover - compiled
    """Mean (k, n) and covariance (k, n, n) of mixtures of Gaussians.

    Args:
        x: (k, m, n). P: (k, m, n, n). weight: (k, m). reference: (k, n) about which yaws are averaged.
    """
    count, m, n = x.shape
    mean, cov = np.empty((count, n)), np.zeros((count, n, n))
    for t in range(count):
        _mean_about(x[t], weight[t], reference[t], mean[t])
        _spread(x[t], weight[t], mean[t], cov[t])
        for j in range(m):
            for i in range(n):
                for k in range(n):
                    cov[t, i, k] += weight[t, j] * P[t, j, i, k]
    return mean, cov


@njit(cache=True, nogil=True, error_model="numpy")
def unscented(
    points: F64, of_mean: F64, of_cov: F64, noise: F64
) -> tuple[F64, F64]:  # pragma: no cover - compiled
    """Mean (k, n) and covariance (k, n, n) of sigma points (k, 2n + 1, n), the middle one first (2.34-2.35).

    Args:
        points: (k, 2n + 1, n). of_mean, of_cov: (2n + 1,) weights. noise: (k, n, n) to add.
    """
    count, _, n = points.shape
    mean, cov = np.empty((count, n)), noise.copy()
    for t in range(count):
        _mean_about(points[t], of_mean, points[t, 0], mean[t])
        _spread(points[t], of_cov, mean[t], cov[t])
    return mean, cov


@njit(cache=True, nogil=True, error_model="numpy")
def upper_root(P: F64) -> tuple[F64, Bool]:  # pragma: no cover - compiled
    """Upper triangular C (k, n, n), C C' = P, and (k,) whether P had one."""
    count, n, _ = P.shape
    C, found = np.zeros_like(P), np.ones(count, np.bool_)
    for t in range(count):
        for j in range(n - 1, -1, -1):
            rest = P[t, j, j]
            for k in range(j + 1, n):
                rest -= C[t, j, k] ** 2
            if not rest > 0:
                found[t] = False
                break
            C[t, j, j] = np.sqrt(rest)
            for i in range(j):
                rest = P[t, i, j]
                for k in range(j + 1, n):
                    rest -= C[t, i, k] * C[t, j, k]
                C[t, i, j] = rest / C[t, j, j]
    return C, found


@njit(cache=True, nogil=True, error_model="numpy")
def _tame(P: F64) -> F64:  # pragma: no cover - compiled
    out, n = np.empty_like(P), P.shape[1]
    scale = np.empty(n)
    for t in range(len(P)):
        for i in range(n):
            scale[i] = min(1.0, MAX_STD[i] / np.sqrt(max(P[t, i, i], 1e-300)))
        for i in range(n):
            for k in range(n):
                out[t, i, k] = 0.5 * (P[t, i, k] + P[t, k, i]) * scale[i] * scale[k]
    return out


def tame(P: F64) -> F64:
    """Symmetric covariance (..., n, n) whose deviations stay within `MAX_STD`, scaled as D P D."""
    n = P.shape[-1]
    return np.asarray(_tame(np.ascontiguousarray(P).reshape(-1, n, n)).reshape(P.shape))


@njit(cache=True, nogil=True, error_model="numpy")
def gathered(prior_x, prior_P, x, P, track, beta, missed):  # type: ignore[no-untyped-def]  # pragma: no cover
    """States (t, m, n) and covariances (t, m, n, n) over all outcomes of an association (2.63-2.67).

    Args:
        prior_x: (t, m, n), prior_P: (t, m, n, n) where no box is the track's.
        x: (p, m, n), P: (p, m, n, n) corrected by each pair; track, beta: (p,) of the pairs.
        missed: (t,) probability of no box.
    """
    tracks, m, n = prior_x.shape
    moved, second = np.zeros_like(prior_x), np.empty_like(prior_P)
    for t in range(tracks):
        second[t] = missed[t] * prior_P[t]
    shift = np.empty(n)
    for p in range(len(track)):
        t, b = track[p], beta[p]
        for j in range(m):
            for i in range(n):
                shift[i] = x[p, j, i] - prior_x[t, j, i]
            shift[PSI] = wrapped(shift[PSI])
            for i in range(n):
                moved[t, j, i] += b * shift[i]
                for k in range(n):
                    second[t, j, i, k] += b * (P[p, j, i, k] + shift[i] * shift[k])
    for t in range(tracks):
        for j in range(m):
            for i in range(n):
                for k in range(n):
                    second[t, j, i, k] -= moved[t, j, i] * moved[t, j, k]
    moved += prior_x
    for t in range(tracks):
        for j in range(m):
            moved[t, j, PSI] = wrapped(moved[t, j, PSI])
    return moved, second
