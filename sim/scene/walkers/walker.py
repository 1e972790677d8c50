"""One person on foot: a body, a pace and a place in its party."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from datmo.arrays import F64
from datmo.geometry import wrap_angle
from scenarios import spec
from sim.scene.vehicles import State, body
from sim.scene.walkers import gait
from sim.scene.walkers.social import FASTEST

PACE = 0.08  # standard deviation of the speed, relative
ALIKE = 0.03  # within a party
SPREAD = 0.3  # standard deviation of the walk's sideways place [m]
TURNING = 3.0  # [rad/s]
TURN_ABOVE = 0.3  # the heading follows the velocity above this speed [m/s]


class Walker:
    """The body of one person, and where it is.

    Args:
        walk: what the scenario says. name: its id. rng: of its variety.
        pace: of the one it walks with [m/s], None for the first of a party.

    Attributes:
        xy, velocity: (2,) [m, world]. aside: its own line is so far to the left of the party's [m].
        walked: [m].
    """

    def __init__(
        self, walk: spec.Pedestrian, name: int, rng: np.random.Generator, pace: float | None
    ) -> None:
        looks = gait.looks_of(walk.age)
        self.name, self.body = name, body(looks[int(rng.integers(len(looks)))])
        if pace is None:
            self.pace = walk.pace * float(np.clip(1 + PACE * rng.normal(), 0.7, 1.3))
        else:
            self.pace = pace * float(np.clip(1 + ALIKE * rng.normal(), 0.9, 1.1))
        self.spread = float(np.clip(SPREAD * rng.normal(), -0.6, 0.6))
        self.cycle = float(rng.uniform(0, 1))
        self.aside = self.walked = self.yaw = self.yaw_rate = 0.0
        self.xy, self.velocity = np.zeros(2), np.zeros(2)
        self.home = self.xy

    @property
    def speed(self) -> float:
        """[m/s]."""
        return float(np.hypot(self.velocity[0], self.velocity[1]))

    def capped(self, velocity: F64) -> F64:
        """At most FASTEST times its pace."""
        speed = float(np.hypot(velocity[0], velocity[1]))
        return velocity * min(1.0, FASTEST * self.pace / max(speed, 1e-9))

    def move(self, velocity: F64, facing: float, dt: float) -> None:
        """Take a velocity (2,) [m/s], and look along it, or towards `facing` [rad] when slow."""
        step = (self.velocity + velocity) / 2 * dt
        self.xy, self.velocity = self.xy + step, velocity
        moved = float(np.hypot(step[0], step[1]))
        self.walked += moved
        self.cycle += gait.cycles(self.body.asset, self.body.kind, moved, self.speed)
        yaw = self.turned(velocity, facing, dt)
        self.yaw, self.yaw_rate = yaw, (yaw - self.yaw) / dt

    def turned(self, velocity: F64, facing: float, dt: float) -> float:
        """Its heading after `dt` [rad]: as far round as it can turn."""
        fast = np.hypot(velocity[0], velocity[1]) > TURN_ABOVE
        heading = np.arctan2(velocity[1], velocity[0]) if fast else facing
        change = np.clip(wrap_angle(heading - self.yaw), -TURNING * dt, TURNING * dt)
        return self.yaw + float(change)

    def state(self) -> State:
        """Where it is, with the mesh of this phase of its gait."""
        shown = gait.key(self.body.asset, self.body.kind, self.cycle, self.speed)
        looks = replace(self.body, asset=shown)
        return State(self.name, looks, self.xy, self.yaw, self.velocity, self.yaw_rate)
