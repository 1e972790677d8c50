"""Motion models over the state [px, py, psi, v, omega] (2.7; method.md section 9).

Each gives the mean motion and the noise gathered over a time step. Noise is white in continuous
time, so two steps of T/2 gather what one of T does.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.geometry import wrap_angle
from datmo.tracks.config import TrackerConfig

PX, PY, PSI, V, OMEGA = range(5)
STRAIGHT = 1e-6  # yaw rate [rad/s] below which CTRV is taken at its limit
FLOOR = 1e-9  # variance that keeps an untouched coordinate positive definite


class MotionModel(ABC):
    """How a state moves in `dt` and how uncertain that is."""

    has_yaw_rate: bool
    stands: bool = False  # whether it keeps the place whatever the speed

    @abstractmethod
    def propagate(self, x: F64, dt: float) -> F64:
        """States (..., 5) after `dt` [s]."""

    @abstractmethod
    def noise(self, x: F64, dt: float) -> F64:
        """Process noise (..., 5, 5) gathered over `dt` [s] by states (..., 5)."""


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
        out = x.copy()
        out[..., PX] += x[..., V] * dt * np.cos(x[..., PSI])
        out[..., PY] += x[..., V] * dt * np.sin(x[..., PSI])
        if not self.keeps_yaw_rate:
            out[..., OMEGA] = 0
        return out

    def noise(self, x: F64, dt: float) -> F64:
        """See `MotionModel`: acceleration along, a random walk of the heading across."""
        Q, speed = _along(x, dt, self.accel_density), x[..., V]
        Q[..., 1, 1] += speed**2 * self.heading_density * dt**3 / 3
        Q[..., 1, 2] = Q[..., 2, 1] = speed * self.heading_density * dt**2 / 2
        Q[..., 2, 2] += self.heading_density * dt
        return _to_world(Q, x[..., PSI])


@dataclass(frozen=True)
class ConstantTurn(MotionModel):
    """CTRV: constant turn rate and speed."""

    accel_density: float
    yaw_accel_density: float
    has_yaw_rate = True

    def propagate(self, x: F64, dt: float) -> F64:
        """See `MotionModel`; the limit of no turn is CV."""
        out, half = x.copy(), x[..., OMEGA] * dt / 2
        # v/w (sin(psi + w T) - sin psi) = v T cos(psi + w T / 2) sin(w T / 2) / (w T / 2)
        chord = np.where(np.abs(half) < STRAIGHT, 1 - half**2 / 6, np.sinc(half / np.pi)) * x[..., V] * dt
        out[..., PX] += chord * np.cos(x[..., PSI] + half)
        out[..., PY] += chord * np.sin(x[..., PSI] + half)
        out[..., PSI] = wrap_angle(x[..., PSI] + 2 * half)
        return out

    def noise(self, x: F64, dt: float) -> F64:
        """See `MotionModel`: yaw acceleration integrates to heading and place across."""
        Q, speed, q = _along(x, dt, self.accel_density), x[..., V], self.yaw_accel_density
        Q[..., 1, 1] += speed**2 * q * dt**5 / 20
        Q[..., 1, 2] = Q[..., 2, 1] = speed * q * dt**4 / 8
        Q[..., 1, 4] = Q[..., 4, 1] = speed * q * dt**3 / 6
        Q[..., 2, 2] += q * dt**3 / 3
        Q[..., 2, 4] = Q[..., 4, 2] = q * dt**2 / 2
        Q[..., 4, 4] += q * dt
        return _to_world(Q, x[..., PSI])


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
        return x.copy()

    def noise(self, x: F64, dt: float) -> F64:
        """See `MotionModel`."""
        diagonal = (self.random_density, self.random_density, self.heading_density, self.accel_density, 0)
        return np.broadcast_to(np.diag(diagonal) * dt + FLOOR * np.eye(5), (*x.shape, 5)).copy()


def make_models(config: TrackerConfig) -> tuple[MotionModel, ...]:
    """The models that the configuration names, in its order."""
    c = config
    known: dict[str, MotionModel] = {
        "cv": ConstantVelocity(c.accel_density, c.heading_density, c.cv_keeps_yaw_rate),
        "ctrv": ConstantTurn(c.accel_density, c.yaw_accel_density),
        "rm": RandomMotion(c.random_density, c.accel_density, c.heading_density),
    }
    return tuple(known[name] for name in config.models)


def _along(x: F64, dt: float, density: float) -> F64:
    """White acceleration along the heading, axes (along, across, psi, v, omega)."""
    Q = np.zeros((*x.shape, 5))
    Q[..., 0, 0] = density * dt**3 / 3
    Q[..., 0, 3] = Q[..., 3, 0] = density * dt**2 / 2
    Q[..., 3, 3] = density * dt
    return np.asarray(Q + FLOOR * np.eye(5))


def _to_world(Q: F64, psi: F64) -> F64:
    G = np.zeros_like(Q)
    c, s = np.cos(psi), np.sin(psi)
    G[..., 0, 0], G[..., 0, 1], G[..., 1, 0], G[..., 1, 1] = c, -s, s, c
    G[..., 2, 2] = G[..., 3, 3] = G[..., 4, 4] = 1
    return np.asarray(np.einsum("...ij,...jk,...lk->...il", G, Q, G))
