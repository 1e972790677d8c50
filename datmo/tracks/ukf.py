"""The unscented Kalman filter over many tracks at once (2.27-2.43; method.md section 10)."""

from __future__ import annotations

from functools import cache

import numpy as np

from datmo.arrays import F64
from datmo.geometry import wrap_angle
from datmo.tracks.filters import Filters
from datmo.tracks.models import PSI, MotionModel

ALPHA, BETA, KAPPA = 1.0, 2.0, 0.0
JITTER = 1e-9
MAX_STD = np.array([np.inf, np.inf, 1.0, 30.0, 1.5, 10.0])  # beyond these a deviation means nothing


@cache
def weights(n: int) -> tuple[float, F64, F64]:
    """Spread n + lambda, and weights (2n + 1,) of mean and covariance, of n coordinates (2.29-2.31)."""
    spread = ALPHA**2 * (n + KAPPA)
    mean = np.full(2 * n + 1, 0.5 / spread)
    cov = mean.copy()
    mean[0] = 1 - n / spread
    cov[0] = mean[0] + 1 - ALPHA**2 + BETA
    return spread, mean, cov


def residual(a: F64, b: F64) -> F64:
    """a - b of states (..., n), the yaw on the circle."""
    d = np.asarray(a - b)
    d[..., PSI] = wrap_angle(d[..., PSI])
    return d


def mean_about(x: F64, weights: F64, reference: F64) -> F64:
    """Weighted mean (..., n) of states (..., m, n), yaw taken as differences from `reference`.

    Equal to the linear mean away from +-pi, and independent of where the circle is cut.
    """
    mean = np.einsum("...m,...mi->...i", weights, residual(x, reference[..., None, :])) + reference
    mean[..., PSI] = wrap_angle(mean[..., PSI])
    return np.asarray(mean)


def square_root(P: F64) -> tuple[F64, int]:
    """Factors C (k, n, n), C C' = P, and how many matrices needed a jitter to have one.

    Taken from the last coordinate up: the columns that turn and speed up do not depend on how the
    world's axes lie, and those of the place alone enter every model linearly. So a turned world
    gives turned results, which the usual factor, place first, does not.
    """
    C, repaired = _cholesky(P[:, ::-1, ::-1])
    return C[:, ::-1, ::-1], repaired


def _cholesky(P: F64) -> tuple[F64, int]:
    try:
        return np.asarray(np.linalg.cholesky(P), np.float64), 0
    except np.linalg.LinAlgError:
        factors, repaired = np.empty_like(P), 0
        for i, matrix in enumerate(P):
            factors[i], fixed = _repaired(matrix)
            repaired += fixed
        return factors, repaired


def sigma_points(x: F64, P: F64) -> tuple[F64, int]:
    """Sigma points (k, 2n + 1, n) of (k, n), (k, n, n), and the number of repaired covariances."""
    C, repaired = square_root(weights(x.shape[-1])[0] * P)
    columns = np.swapaxes(C, -1, -2)
    return np.concatenate([x[:, None], x[:, None] + columns, x[:, None] - columns], 1), repaired


def tame(P: F64) -> F64:
    """Symmetric covariance whose deviations stay within `MAX_STD`, scaled as D P D."""
    P = 0.5 * (P + np.swapaxes(P, -1, -2))
    std = np.sqrt(np.maximum(np.einsum("...ii->...i", P), 1e-300))
    D = np.minimum(1.0, MAX_STD[: std.shape[-1]] / std)
    return np.asarray(P * D[..., :, None] * D[..., None, :])


class BatchedFilters(Filters):
    """All states of a model in one array operation."""

    def predict(self, model: MotionModel, x: F64, P: F64, dt: float) -> tuple[F64, F64]:
        """See `Filters` (2.32-2.35)."""
        points, repaired = sigma_points(x, P)
        self.jitters += repaired
        Q = model.noise(x, dt)
        moved = model.propagate(points, dt)
        _, of_mean, of_cov = weights(x.shape[-1])
        mean = mean_about(moved, of_mean[None], moved[:, 0])
        d = residual(moved, mean[:, None])
        return mean, tame(np.einsum("m,nmi,nmj->nij", of_cov, d, d) + Q)

    def correct(self, x: F64, P: F64, z: F64, R: F64, yaw: F64, yaw_var: F64) -> tuple[F64, F64]:
        """See `Filters` (2.36-2.43).

        Place and yaw are coordinates of the state, and a transform of redrawn sigma points through
        a linear function is exact: P_xz and P_z are blocks of P.
        """
        S = P[:, :2, :2] + R
        K = np.einsum("nij,njk->nik", P[:, :, :2], inverse_2x2(S))
        x = x + np.einsum("nij,nj->ni", K, z - x[:, :2])
        P = P - np.einsum("nij,njk,nlk->nil", K, S, K)
        used = np.isfinite(yaw)
        s = P[:, PSI, PSI] + np.where(used, yaw_var, 1.0)
        k = np.where(used[:, None], P[:, :, PSI] / s[:, None], 0.0)
        x = x + k * half_turn(np.where(used, yaw, 0.0) - x[:, PSI])[:, None]
        P = P - s[:, None, None] * k[:, :, None] * k[:, None, :]
        x[:, PSI] = wrap_angle(x[:, PSI])
        return x, tame(P)


def half_turn(angle: F64) -> F64:
    """The same direction, heads and tails alike, in [-pi/2, pi/2) [rad]."""
    return np.asarray((angle + np.pi / 2) % np.pi - np.pi / 2)


def inverse_2x2(S: F64) -> F64:
    """Inverse of symmetric (..., 2, 2)."""
    a, b, c = S[..., 0, 0], S[..., 0, 1], S[..., 1, 1]
    rows = np.stack([np.stack([c, -b], -1), np.stack([-b, a], -1)], -2)
    return np.asarray(rows / (a * c - b * b)[..., None, None])


def _repaired(P: F64) -> tuple[F64, int]:
    try:
        return np.asarray(np.linalg.cholesky(P), np.float64), 0
    except np.linalg.LinAlgError:
        values, vectors = np.linalg.eigh(P)
        lifted = np.maximum(values, JITTER * max(float(values[-1]), 1.0))
        lifted_P = (vectors * lifted) @ vectors.T + JITTER * np.eye(len(P))
        return np.asarray(np.linalg.cholesky(lifted_P), np.float64), 1
