"""The models of the thesis's future work: CTRA, CSAV and CCA (Schubert, Richter and Wanielik 2008)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.geometry import wrap_angle
from datmo.tracks.models.base import (
    ACCEL,
    OMEGA,
    PSI,
    PX,
    PY,
    MotionModel,
    V,
    along,
    along_jerked,
    turning,
    unaccelerated,
)

SLOW = 0.5  # [m/s] below which what moves shows no curvature
NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)
NODES, WEIGHTS = (NODES + 1) / 2, WEIGHTS / 2


@dataclass(frozen=True)
class ConstantTurnAcceleration(MotionModel):
    """CTRA: constant turn rate and acceleration."""

    jerk_density: float
    yaw_accel_density: float
    has_yaw_rate = True
    has_acceleration = True

    def propagate(self, x: F64, dt: float) -> F64:
        """See `MotionModel`."""
        out = _arc(x, dt, lambda t: x[..., OMEGA, None] * t)
        out[..., V] += x[..., ACCEL] * dt
        return out

    def noise(self, x: F64, dt: float) -> F64:
        """See `MotionModel`: jerk along, yaw acceleration across."""
        return turning(along_jerked(x, dt, self.jerk_density), x, dt, self.yaw_accel_density)


@dataclass(frozen=True)
class ConstantSteering(MotionModel):
    """CSAV: constant steering angle and velocity. A steering angle is a curvature; its rate scatters."""

    accel_density: float
    curvature_density: float
    has_yaw_rate = True

    def propagate(self, x: F64, dt: float) -> F64:
        """See `MotionModel`; an arc of the curvature omega / v."""
        x = unaccelerated(x.copy())
        rate = curvature(x) * x[..., V]
        out = _arc(x, dt, lambda t: rate[..., None] * t)
        out[..., OMEGA] = rate
        return out

    def noise(self, x: F64, dt: float) -> F64:
        """See `MotionModel`: acceleration along, the curvature's random walk across."""
        return turning(along(x, dt, self.accel_density), x, dt, x[..., V] ** 2 * self.curvature_density)


@dataclass(frozen=True)
class ConstantCurvature(MotionModel):
    """CCA: constant curvature and acceleration; who brakes on an arc turns more slowly."""

    jerk_density: float
    curvature_density: float
    has_yaw_rate = True
    has_acceleration = True

    def propagate(self, x: F64, dt: float) -> F64:
        """See `MotionModel`; the heading turns by the curvature times the way."""
        bend, v, a = curvature(x), x[..., V, None], x[..., ACCEL, None]
        out = _arc(x, dt, lambda t: bend[..., None] * (v * t + a * t**2 / 2))
        out[..., V] += x[..., ACCEL] * dt
        out[..., OMEGA] = bend * out[..., V]
        return out

    def noise(self, x: F64, dt: float) -> F64:
        """See `MotionModel`: jerk along, the curvature's random walk across."""
        return turning(along_jerked(x, dt, self.jerk_density), x, dt, x[..., V] ** 2 * self.curvature_density)


def curvature(x: F64) -> F64:
    """omega / v (...) [1/m], fading to none below `SLOW`."""
    speed = x[..., V]
    return np.asarray(x[..., OMEGA] * speed / np.maximum(speed**2, SLOW**2))


def _arc(x: F64, dt: float, turned: Callable[[F64], F64]) -> F64:
    """States moved along the arc whose heading has turned by `turned(t)` (..., k) at times t (k,).

    The place is the integral of v(t) (cos psi(t), sin psi(t)) by Gauss and Legendre, six nodes: exact to
    rounding for any turn below a radian, with no limit to take where the turn is none.
    """
    out, t = x.copy(), NODES * dt
    speed, psi = x[..., V, None], x[..., PSI, None] + turned(t)
    if x.shape[-1] > ACCEL:
        speed = speed + x[..., ACCEL, None] * t
    out[..., PX] += dt * np.sum(WEIGHTS * speed * np.cos(psi), axis=-1)
    out[..., PY] += dt * np.sum(WEIGHTS * speed * np.sin(psi), axis=-1)
    out[..., PSI] = wrap_angle(x[..., PSI] + turned(np.array([dt]))[..., 0])
    return out
