"""Scripted actors: parked at a point, or driven smoothly through way-points in time."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from datmo.arrays import F64
from scenarios import spec
from sim.scene.autopilot import STEP, Claim
from sim.scene.curve import hermite
from sim.scene.vehicles import Body, State

STILL = 0.05  # below this speed [m/s] the heading is held
FINE = 0.02  # spacing of the table of headings [s]
NOTICE = 4.0  # others keep off the way of the next seconds [s]


class Script:
    """Where a scripted actor is at any time.

    Each coordinate is the monotone cubic of the way-points (Fritsch-Carlson), so that a way-point
    given twice is a stop without overshoot. Before the first and after the last way-point the
    actor goes on with the speed it has there. The heading follows the motion; while the actor
    stands it is held.

    Args:
        actor: the actor of the scenario.
    """

    def __init__(self, actor: spec.Actor) -> None:
        self._times = np.array([p.t for p in actor.path])
        self._xy = np.array([(p.x, p.y) for p in actor.path])
        self._fixed = np.deg2rad(actor.yaw_deg or 0.0)
        self._rates = np.zeros_like(self._xy)
        if len(actor.path) > 1:
            self._rates = PchipInterpolator(self._times, self._xy).derivative()(self._times)
        self._table, self._headings = self._heading_table()

    @property
    def parked(self) -> bool:
        """Whether the actor never moves."""
        return len(self._times) == 1

    def position(self, times: F64) -> F64:
        """Places (m, 2) [m, world] at `times` (m,) [s since the first scan]."""
        return hermite(self._times, self._xy, self._rates, np.asarray(times, float))

    def velocity(self, times: F64) -> F64:
        """Velocities (m, 2) [m/s, world]: the curve's own slope."""
        h = 1e-4
        t = np.asarray(times, float)
        return (self.position(t + h) - self.position(t - h)) / (2 * h)

    def yaw(self, times: F64) -> F64:
        """Headings (m,) [rad, world], unwrapped."""
        return np.asarray(np.interp(np.asarray(times, float), self._table, self._headings))

    def state(self, name: int, looks: Body, time: float) -> State:
        """Where the actor is at `time` [s since the first scan]."""
        t = np.array([time])
        rate = float((self.yaw(t + FINE) - self.yaw(t - FINE))[0] / (2 * FINE))
        return State(name, looks, self.position(t)[0], float(self.yaw(t)[0]), self.velocity(t)[0], rate)

    def claim(self, looks: Body, time: float) -> Claim:
        """The ground it stands on and the ground it will drive over in the next seconds."""
        times = np.array([time]) if self.parked else np.linspace(time, time + NOTICE, 17)
        along = np.arange(-looks.length / 2, looks.length / 2 + STEP, STEP)
        yaw = self.yaw(times)[:, None, None]
        body = along[:, None] * np.concatenate([np.cos(yaw), np.sin(yaw)], -1)
        return Claim((self.position(times)[:, None] + body).reshape(-1, 2), looks.width / 2)

    def _heading_table(self) -> tuple[F64, F64]:
        if self.parked:
            return self._times, np.array([self._fixed])
        count = int(np.ceil((self._times[-1] - self._times[0]) / FINE)) + 1
        t = np.linspace(self._times[0], self._times[-1], max(count, 2))
        v = self.velocity(t)
        moving = np.flatnonzero(np.hypot(v[:, 0], v[:, 1]) > STILL)
        if len(moving) == 0:
            return t, np.full(len(t), self._fixed)
        yaw = np.unwrap(np.arctan2(v[moving, 1], v[moving, 0]))
        return t, np.interp(t, t[moving], yaw)
