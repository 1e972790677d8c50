"""The unscented Kalman filter over many tracks at once (2.27-2.43; method.md section 10)."""

from __future__ import annotations

from functools import cache

import numpy as np
from numba import njit

from datmo.arrays import F64
from datmo.tracks.filters.base import Filters
from datmo.tracks.filters.moments import tame, unscented, upper_root, wrapped
from datmo.tracks.models import PSI, MotionModel

ALPHA, BETA, KAPPA = 1.0, 2.0, 0.0
JITTER = 1e-9


@cache
def weights(n: int) -> tuple[float, F64, F64]:
    """Spread n + lambda, and weights (2n + 1,) of mean and covariance, of n coordinates (2.29-2.31)."""
    spread = ALPHA**2 * (n + KAPPA)
    mean = np.full(2 * n + 1, 0.5 / spread)
    cov = mean.copy()
    mean[0] = 1 - n / spread
    cov[0] = mean[0] + 1 - ALPHA**2 + BETA
    return spread, mean, cov


def square_root(P: F64) -> tuple[F64, int]:
    """Factors C (k, n, n), C C' = P, and how many matrices needed a jitter to have one.

    Taken from the last coordinate up: the columns that turn and speed up do not depend on how the
    world's axes lie, and those of the place alone enter every model linearly. So a turned world
    gives turned results, which the usual factor, place first, does not.
    """
    C, found = upper_root(np.ascontiguousarray(P))
    bad = np.flatnonzero(~found)
    for i in bad:
        C[i] = _repaired(P[i, ::-1, ::-1])[::-1, ::-1]
    return C, len(bad)


def sigma_points(x: F64, P: F64) -> tuple[F64, int]:
    """Sigma points (k, 2n + 1, n) of (k, n), (k, n, n), and the number of repaired covariances."""
    C, repaired = square_root(weights(x.shape[-1])[0] * P)
    columns = np.swapaxes(C, -1, -2)
    return np.concatenate([x[:, None], x[:, None] + columns, x[:, None] - columns], 1), repaired


class BatchedFilters(Filters):
    """All states of a model in one array operation."""

    def predict(self, model: MotionModel, x: F64, P: F64, dt: float) -> tuple[F64, F64]:
        """See `Filters` (2.32-2.35)."""
        points, repaired = sigma_points(x, P)
        self.jitters += repaired
        Q = model.noise(x, dt)
        moved = model.propagate(points, dt)
        _, of_mean, of_cov = weights(x.shape[-1])
        mean, cov = unscented(np.ascontiguousarray(moved), of_mean, of_cov, Q)
        return mean, tame(cov)

    def correct(self, x: F64, P: F64, z: F64, R: F64, yaw: F64, yaw_var: F64) -> tuple[F64, F64]:
        """See `Filters` (2.36-2.43).

        Place and yaw are coordinates of the state, and a transform of redrawn sigma points through
        a linear function is exact: P_xz and P_z are blocks of P.
        """
        x, P = np.array(x), np.array(P)
        _corrected(x, P, z, R, yaw, yaw_var)
        return x, tame(P)


@njit(cache=True, nogil=True, error_model="numpy")
def _corrected(x, P, z, R, yaw, yaw_var):  # type: ignore[no-untyped-def]  # pragma: no cover - compiled
    """States (k, n) and covariances (k, n, n) by the place, then by the yaw where there is one; in place."""
    count, n = x.shape
    K, k = np.empty((n, 2)), np.empty(n)
    for t in range(count):
        a, b, c = P[t, 0, 0] + R[t, 0, 0], P[t, 0, 1] + R[t, 0, 1], P[t, 1, 1] + R[t, 1, 1]
        det, dx, dy = a * c - b * b, z[t, 0] - x[t, 0], z[t, 1] - x[t, 1]
        for i in range(n):
            K[i, 0] = (P[t, i, 0] * c - P[t, i, 1] * b) / det
            K[i, 1] = (P[t, i, 1] * a - P[t, i, 0] * b) / det
            x[t, i] += K[i, 0] * dx + K[i, 1] * dy
        for i in range(n):
            u, v = K[i, 0] * a + K[i, 1] * b, K[i, 0] * b + K[i, 1] * c
            for j in range(n):
                P[t, i, j] -= u * K[j, 0] + v * K[j, 1]
        if np.isfinite(yaw[t]):
            s = P[t, PSI, PSI] + yaw_var[t]
            d = (yaw[t] - x[t, PSI] + np.pi / 2) % np.pi - np.pi / 2
            for i in range(n):
                k[i] = P[t, i, PSI] / s
            for i in range(n):
                x[t, i] += k[i] * d
                for j in range(n):
                    P[t, i, j] -= s * k[i] * k[j]
        x[t, PSI] = wrapped(x[t, PSI])


def inverse_2x2(S: F64) -> F64:
    """Inverse of symmetric (..., 2, 2)."""
    det, out = S[..., 0, 0] * S[..., 1, 1] - S[..., 0, 1] ** 2, np.empty_like(S)
    out[..., 0, 0], out[..., 1, 1] = S[..., 1, 1] / det, S[..., 0, 0] / det
    out[..., 0, 1] = out[..., 1, 0] = -S[..., 0, 1] / det
    return out


def _repaired(P: F64) -> F64:
    values, vectors = np.linalg.eigh(P)
    lifted = np.maximum(values, JITTER * max(float(values[-1]), 1.0))
    lifted_P = (vectors * lifted) @ vectors.T + JITTER * np.eye(len(P))
    return np.asarray(np.linalg.cholesky(lifted_P), np.float64)
