"""The thesis's models: constant velocity, constant turn rate and velocity, random motion (2.9-2.10)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.geometry import wrap_angle
from datmo.tracks.models.base import (
    FLOOR,
    OMEGA,
    PSI,
    PX,
    PY,
    MotionModel,
    V,
    along,
    to_world,
    turning,
    unaccelerated,
)

STRAIGHT = 1e-6  # half turn [rad] below which CTRV is taken at its limit


@dataclass(frozen=True)
class ConstantVelocity(MotionModel):
    """CV; the yaw rate becomes zero, or is kept as the thesis has it."""

    accel_density: float
    heading_density: float
    keeps_yaw_rate: bool = False

    @property
    def has_yaw_rate(self) -> bool:  # type: ignore[override]
        """Whether the state's yaw rate means anything under this model."""
        return self.keeps_yaw_rate

    def propagate(self, x: F64, dt: float) -> F64:
        """See `MotionModel`."""
        out = unaccelerated(x.copy())
        out[..., PX] += x[..., V] * dt * np.cos(x[..., PSI])
        out[..., PY] += x[..., V] * dt * np.sin(x[..., PSI])
        if not self.keeps_yaw_rate:
            out[..., OMEGA] = 0
        return out

    def noise(self, x: F64, dt: float) -> F64:
        """See `MotionModel`: acceleration along, a random walk of the heading across."""
        Q, speed = along(x, dt, self.accel_density), x[..., V]
        Q[..., 1, 1] += speed**2 * self.heading_density * dt**3 / 3
        Q[..., 1, PSI] = Q[..., PSI, 1] = speed * self.heading_density * dt**2 / 2
        Q[..., PSI, PSI] += self.heading_density * dt
        return to_world(Q, x[..., PSI])


@dataclass(frozen=True)
class ConstantTurn(MotionModel):
    """CTRV: constant turn rate and speed."""

    accel_density: float
    yaw_accel_density: float
    has_yaw_rate = True

    def propagate(self, x: F64, dt: float) -> F64:
        """See `MotionModel`; the limit of no turn is CV."""
        out, half = unaccelerated(x.copy()), x[..., OMEGA] * dt / 2
        # v/w (sin(psi + w T) - sin psi) = v T cos(psi + w T / 2) sin(w T / 2) / (w T / 2)
        chord = np.where(np.abs(half) < STRAIGHT, 1 - half**2 / 6, np.sinc(half / np.pi)) * x[..., V] * dt
        out[..., PX] += chord * np.cos(x[..., PSI] + half)
        out[..., PY] += chord * np.sin(x[..., PSI] + half)
        out[..., PSI] = wrap_angle(x[..., PSI] + 2 * half)
        return out

    def noise(self, x: F64, dt: float) -> F64:
        """See `MotionModel`: acceleration along, yaw acceleration across."""
        return turning(along(x, dt, self.accel_density), x, dt, self.yaw_accel_density)


@dataclass(frozen=True)
class RandomMotion(MotionModel):
    """RM: stays, with a noise that is much larger in position."""

    random_density: float
    accel_density: float
    heading_density: float
    has_yaw_rate = False
    stands = True

    def propagate(self, x: F64, dt: float) -> F64:  # noqa: ARG002 - it stays
        """See `MotionModel`."""
        return unaccelerated(x.copy())

    def noise(self, x: F64, dt: float) -> F64:
        """See `MotionModel`."""
        n = x.shape[-1]
        diagonal = np.zeros(n)
        diagonal[:4] = self.random_density, self.random_density, self.heading_density, self.accel_density
        return np.broadcast_to(np.diag(diagonal) * dt + FLOOR * np.eye(n), (*x.shape, n)).copy()
