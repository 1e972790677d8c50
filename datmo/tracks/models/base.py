"""What a motion model is, and the pieces of process noise they share.

The state is [px, py, psi, v, omega] (2.7), with the acceleration along the heading as a sixth
coordinate where a model of the IMM knows one. Noise is white in continuous time, so two steps of
T/2 gather what one of T does.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numba import njit

from datmo.arrays import F64

PX, PY, PSI, V, OMEGA, ACCEL = range(6)
FLOOR = 1e-9  # variance that keeps an untouched coordinate positive definite


class MotionModel(ABC):
    """How a state moves in `dt` and how uncertain that is.

    A model that has no yaw rate or no acceleration sets that coordinate to zero.
    """

    has_yaw_rate: bool
    has_acceleration: bool = False
    stands: bool = False  # whether it keeps the place whatever the speed

    @abstractmethod
    def propagate(self, x: F64, dt: float) -> F64:
        """States (..., n) after `dt` [s]."""

    @abstractmethod
    def noise(self, x: F64, dt: float) -> F64:
        """Process noise (..., n, n) gathered over `dt` [s] by states (..., n)."""


def velocity(mean: F64) -> F64:
    """(t, 2) [m/s] of states (t, n)."""
    return np.asarray(mean[:, V, None] * np.column_stack([np.cos(mean[:, PSI]), np.sin(mean[:, PSI])]))


def unaccelerated(x: F64) -> F64:
    """States (..., n) with no acceleration, in place; nothing where the state has none."""
    x[..., ACCEL:] = 0
    return x


def along(x: F64, dt: float, density: float) -> F64:
    """White acceleration of `density` [m²/s³] along the heading, axes (along, across, psi, v, ...)."""
    n = x.shape[-1]
    Q = np.zeros((*x.shape, n))
    Q[..., 0, 0] = density * dt**3 / 3
    Q[..., 0, V] = Q[..., V, 0] = density * dt**2 / 2
    Q[..., V, V] = density * dt
    return np.asarray(Q + FLOOR * np.eye(n))


def along_jerked(x: F64, dt: float, density: float) -> F64:
    """White jerk of `density` [m²/s⁵] along the heading, axes (along, across, psi, v, omega, a)."""
    Q = np.zeros((*x.shape, x.shape[-1]))
    chain = np.array(
        [
            [dt**5 / 20, dt**4 / 8, dt**3 / 6],
            [dt**4 / 8, dt**3 / 3, dt**2 / 2],
            [dt**3 / 6, dt**2 / 2, dt],
        ]
    )
    rows = np.array([0, V, ACCEL])
    Q[..., rows[:, None], rows] = density * chain
    return np.asarray(Q + FLOOR * np.eye(x.shape[-1]))


def turning(Q: F64, x: F64, dt: float, density: F64 | float) -> F64:
    """Q [world] with white yaw acceleration of `density` (...) [rad²/s³], which turns heading and place.

    Args:
        Q: (..., n, n) of the motion along the heading, axes (along, across, psi, v, ...); changed in place.
        x: (..., n). dt: [s].
    """
    speed = x[..., V]
    Q[..., 1, 1] += speed**2 * density * dt**5 / 20
    Q[..., 1, PSI] = Q[..., PSI, 1] = speed * density * dt**4 / 8
    Q[..., 1, OMEGA] = Q[..., OMEGA, 1] = speed * density * dt**3 / 6
    Q[..., PSI, PSI] += density * dt**3 / 3
    Q[..., PSI, OMEGA] = Q[..., OMEGA, PSI] = density * dt**2 / 2
    Q[..., OMEGA, OMEGA] += density * dt
    return to_world(Q, x[..., PSI])


def to_world(Q: F64, psi: F64) -> F64:
    """Q from axes along and across the heading `psi` (...) to the world's."""
    n = Q.shape[-1]
    flat = np.ascontiguousarray(Q).reshape(-1, n, n)
    _turn(flat, np.cos(psi).reshape(-1), np.sin(psi).reshape(-1))
    return flat.reshape(Q.shape)


@njit(cache=True, nogil=True)
def _turn(Q: F64, c: F64, s: F64) -> None:  # pragma: no cover - compiled
    """Turn the first two axes of Q (k, n, n) by angles of cosines `c`, sines `s` (k,), in place."""
    n = Q.shape[1]
    for t in range(len(Q)):
        for i in range(n):
            x, y = Q[t, 0, i], Q[t, 1, i]
            Q[t, 0, i], Q[t, 1, i] = c[t] * x - s[t] * y, s[t] * x + c[t] * y
        for i in range(n):
            x, y = Q[t, i, 0], Q[t, i, 1]
            Q[t, i, 0], Q[t, i, 1] = c[t] * x - s[t] * y, s[t] * x + c[t] * y
