"""The same tracker on filterpy's unscented filter: slow, readable, the reference."""

from __future__ import annotations

from typing import Any

import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter

from datmo.arrays import F64
from datmo.geometry import half_turn, wrap_angle
from datmo.tracks.filters.base import Filters
from datmo.tracks.filters.moments import tame
from datmo.tracks.filters.ukf import ALPHA, BETA, KAPPA, square_root
from datmo.tracks.models import PSI, MotionModel


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


def _mean(sigmas: F64, weights: F64) -> F64:
    return np.asarray(mean_about(sigmas[None], weights[None], sigmas[:1])[0])


def _add(x: F64, step: F64) -> F64:
    out = np.asarray(x + step)
    out[PSI] = wrap_angle(out[PSI])
    return out


class FilterpyFilters(Filters):
    """One filterpy filter for each state, one after another."""

    def predict(self, model: MotionModel, x: F64, P: F64, dt: float) -> tuple[F64, F64]:
        """See `Filters`."""
        out_x, out_P = np.empty_like(x), np.empty_like(P)
        for i in range(len(x)):
            ukf = self._filter(x[i], P[i], dim_z=2)
            ukf.Q = model.noise(x[i], dt)
            ukf.predict(dt=dt, fx=lambda s, step: model.propagate(s, step))
            out_x[i], out_P[i] = ukf.x, tame(ukf.P)
        return out_x, out_P

    def correct(self, x: F64, P: F64, z: F64, R: F64, yaw: F64, yaw_var: F64) -> tuple[F64, F64]:
        """See `Filters`; place and yaw are one measurement of three here."""
        out_x, out_P = np.empty_like(x), np.empty_like(P)
        for i in range(len(x)):
            sure = bool(np.isfinite(yaw[i]))
            ukf = self._filter(x[i], P[i], dim_z=3 if sure else 2)
            ukf.R = np.zeros((ukf._dim_z, ukf._dim_z))
            ukf.R[:2, :2] = R[i]
            measured = z[i]
            if sure:
                ukf.R[2, 2] = yaw_var[i]
                measured = np.append(z[i], yaw[i])
            ukf.sigmas_f = ukf.points_fn.sigma_points(ukf.x, ukf.P)
            ukf.update(measured)
            out_x[i], out_P[i] = ukf.x, tame(ukf.P)
        return out_x, out_P

    def _filter(self, x: F64, P: F64, dim_z: int) -> Any:
        n = len(x)

        def rows(matrix: F64) -> F64:
            factor, repaired = square_root(matrix[None])
            self.jitters += repaired
            return np.asarray(factor[0].T)

        def residual_z(a: F64, b: F64) -> F64:
            d = np.asarray(a - b)
            if dim_z == 3:
                d[2] = half_turn(d[2])
            return d

        def mean_z(sigmas: F64, weights: F64) -> F64:
            d = residual(_state(sigmas), _state(sigmas[:1]))[:, :dim_z]
            return np.asarray(sigmas[0] + weights @ d)

        def _state(sigmas: F64) -> F64:
            return np.pad(sigmas, ((0, 0), (0, n - dim_z)))

        points = MerweScaledSigmaPoints(n, ALPHA, BETA, KAPPA, sqrt_method=rows)
        ukf = UnscentedKalmanFilter(
            n, dim_z, dt=0.1, hx=lambda s: s[:dim_z], fx=lambda s, _: s, points=points,
            x_mean_fn=_mean, z_mean_fn=mean_z, residual_x=residual, residual_z=residual_z, state_add=_add,
        )  # fmt: skip
        ukf.x, ukf.P = x.copy(), P.copy()
        return ukf
