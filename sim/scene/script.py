"""Scripted actors: parked at a point, or driven smoothly through way-points in time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import PchipInterpolator

from datmo.arrays import F64
from datmo.errors import ScenarioError
from datmo.messages import Kind
from scenarios import spec
from sim.scene.assets import keys
from sim.scene.autopilot import STEP, Claim
from sim.scene.curve import hermite
from sim.scene.vehicles import Body, State, body
from sim.scene.walkers import gait

STILL = 0.05  # below this speed [m/s] the heading is held
FINE = 0.02  # spacing of the table of headings [s]
SLOPE = 1e-4  # the slope of the curve is taken over this, to either side [s]
NOTICE = 4.0  # others keep off the way of the next seconds [s]


def looks_of(actor: spec.Actor) -> Body:
    """The body of a scripted actor.

    Raises:
        ScenarioError: there is no such variant of its kind.
    """
    child = actor.kind == "child"
    known = gait.looks_of("child") if child else keys(Kind[actor.kind.upper()])
    if actor.variant >= len(known):
        raise ScenarioError(
            f"actor {actor.name!r}: variant = {actor.variant}; there are {len(known)} of kind {actor.kind}, "
            f"counted from 0; choose one up to {len(known) - 1}"
        )
    return body(known[actor.variant])


class Script:
    """Where a scripted actor is at any time.

    Each coordinate is the monotone cubic of the way-points (Fritsch-Carlson), so that a way-point
    given twice is a stop without overshoot. Before the first and after the last way-point the
    actor goes on with the speed it has there. The heading follows the motion; while the actor
    stands it is held.

    With a trigger it stands at its first way-point until the ego comes near (`watch`), and its
    times count from there. Persons and
    cyclists show the phase of their gait that the way so far comes to.

    Args:
        actor: the actor of the scenario.
    """

    def __init__(self, actor: spec.Actor) -> None:
        self._cue, self._began = actor.trigger, 0.0 if actor.trigger is None else np.inf
        self._times = np.array([p.t for p in actor.path])
        self._xy = np.array([(p.x, p.y) for p in actor.path])
        self._fixed = np.deg2rad(actor.yaw_deg or 0.0)
        self._rates = np.zeros_like(self._xy)
        if len(actor.path) > 1:
            self._rates = PchipInterpolator(self._times, self._xy).derivative()(self._times)
        self._table, self._headings = self._heading_table()
        speed = np.hypot(*self.velocity(self._table).T)
        mean = (speed[1:] + speed[:-1]) / 2
        self._end_speeds = np.hypot(*self.velocity(self._table[[0, -1]]).T)
        self._arcs = np.concatenate([[0.0], np.cumsum(mean * np.diff(self._table))])

    @property
    def parked(self) -> bool:
        """Whether the actor never moves."""
        return len(self._times) == 1

    def position(self, times: F64) -> F64:
        """Places (m, 2) [m, world] at `times` (m,) [s since the first scan]."""
        return hermite(self._times, self._xy, self._rates, np.asarray(times, float))

    def velocity(self, times: F64) -> F64:
        """Velocities (m, 2) [m/s, world]: the curve's own slope."""
        t = np.asarray(times, float)
        return (self.position(t + SLOPE) - self.position(t - SLOPE)) / (2 * SLOPE)

    def yaw(self, times: F64) -> F64:
        """Headings (m,) [rad, world], unwrapped."""
        return np.asarray(np.interp(np.asarray(times, float), self._table, self._headings))

    def watch(self, ego: F64, time: float) -> None:
        """Begin at `time` [s since the first scan] if the ego at (2,) [m, world] is what it waits for."""
        if self._cue and self._began == np.inf and np.hypot(*(ego - self._xy[0])) < self._cue.distance:
            self._began = time - float(self._times[0])

    def walked(self, times: F64) -> F64:
        """Ways (m,) from the first way-point on [m], negative before it."""
        t = np.asarray(times, float)
        ends = self._table[[0, -1]]
        before, after = self._end_speeds
        beyond = np.minimum(t - ends[0], 0.0) * before + np.maximum(t - ends[1], 0.0) * after
        return np.asarray(np.interp(t, self._table, self._arcs) + beyond)

    def state(self, name: int, looks: Body, time: float) -> State:
        """Where the actor is at `time` [s since the first scan]."""
        if self._waits:
            return State(name, looks, self._xy[0], float(self._headings[0]), np.zeros(2))
        t = np.array([time - self._began])
        behind, yaw, ahead = self.yaw(t + np.array([-FINE, 0.0, FINE]))
        rate = float((ahead - behind) / (2 * FINE))
        before, xy, after = self.position(t + np.array([-SLOPE, 0.0, SLOPE]))
        velocity = (after - before) / (2 * SLOPE)
        speed = float(np.hypot(velocity[0], velocity[1]))
        cycle = gait.cycles(looks.asset, looks.kind, float(self.walked(t)[0]), speed)
        looks = replace(looks, asset=gait.key(looks.asset, looks.kind, cycle, speed))
        return State(name, looks, xy, float(yaw), velocity, rate)

    def claim(self, looks: Body, time: float) -> Claim:
        """The ground it stands on and the ground it will drive over in the next seconds."""
        now = self._times[0] if self._waits else time - self._began
        still = self.parked or self._waits
        times = np.array([now]) if still else np.linspace(now, now + NOTICE, 17)
        along = np.arange(-looks.length / 2, looks.length / 2 + STEP, STEP)
        yaw = self.yaw(times)[:, None, None]
        body = along[:, None] * np.concatenate([np.cos(yaw), np.sin(yaw)], -1)
        return Claim((self.position(times)[:, None] + body).reshape(-1, 2), looks.width / 2)

    @property
    def _waits(self) -> bool:
        return self._began == np.inf

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
