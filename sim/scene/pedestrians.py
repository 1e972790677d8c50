"""Walkers: they go there and back, and wait at the kerb until the road before them is free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from datmo.arrays import F64, Bool
from datmo.geometry import wrap_angle
from datmo.messages import Kind
from scenarios import spec
from sim.scene.assets import GAIT_PHASES, keys
from sim.scene.autopilot import STEP, Claim, RightOfWay
from sim.scene.bodies.person import stride
from sim.scene.roads import Road
from sim.scene.vehicles import State, body

FIRST_ID = 101
RADIUS = 0.4  # ground a walker needs [m]
KERB = 0.3  # a road begins this far beyond its edge [m]
WAIT_AT = 0.4  # a walker waits this far before that [m]
PATIENCE = 2.0  # after it, only vehicles that could not stop any more are waited for [s]
REST = 1.0  # at either end of a walk [s]
ACCELERATION = 1.5  # [m/s²]
TURNING = 3.0  # [rad/s]
SPREAD = 0.3  # standard deviation of the walk's sideways place [m]
PACE = 0.08  # and of the speed, relative


def on_road(points: F64, roads: Sequence[Road]) -> Bool:
    """Which points (n, 2) [m, world] lie on a road, its kerb included."""
    found = np.zeros(len(points), bool)
    for road in roads:
        found |= cKDTree(road.centerline).query(points)[0] < road.width / 2 + KERB
    return found


class Walker:
    """One pedestrian of the scenario, with a pace, a line and a body of its own.

    Args:
        walk: what the scenario says. roads: where it has to look. name: its id.
        rng: of its variety.
    """

    def __init__(
        self, walk: spec.Pedestrian, roads: Sequence[Road], name: int, rng: np.random.Generator
    ) -> None:
        self.walk, self.name = walk, name
        looks = keys(Kind.PEDESTRIAN)
        self.looks = body(looks[int(rng.integers(len(looks)))])
        variant = int(self.looks.asset.split("/")[1])
        self.stride = stride(variant)
        self.pace = walk.speed * float(np.clip(1 + PACE * rng.normal(), 0.7, 1.3))
        start, goal = np.array(walk.start), np.array(walk.goal)
        self.length = float(np.hypot(*(goal - start)))
        self.ahead = (goal - start) / max(self.length, 1e-9)
        side = np.array([-self.ahead[1], self.ahead[0]])
        self.start = start + side * float(np.clip(SPREAD * rng.normal(), -0.6, 0.6))
        self.phase = float(rng.uniform(0, 1))
        self.along, self.speed, self.way, self.rest = 0.0, 0.0, 1, walk.begin
        self.yaw, self.walked = float(np.arctan2(self.ahead[1], self.ahead[0])), 0.0
        self.allowed: tuple[float, float] | None = None
        self.yaw_rate = self.waited = 0.0
        self._crossings = self._find_crossings(roads)

    def step(self, dt: float, right_of_way: RightOfWay) -> None:
        """Walk for `dt` seconds, and claim the ground to be walked on."""
        limit = self._limit(right_of_way)
        self.waited = self.waited + dt if self.rest == 0 and self.speed < 0.05 else 0.0
        stopping = np.sqrt(2 * ACCELERATION * max(limit, 0.0))
        wish = 0.0 if self.rest > 0 or self.walk.behaviour == "waiting" else min(self.pace, stopping)
        change = float(np.clip(wish - self.speed, -2 * ACCELERATION * dt, ACCELERATION * dt))
        before, self.speed = self.speed, max(self.speed + change, 0.0)
        moved = (before + self.speed) / 2 * dt
        self.along = min(self.along + moved, self.length)
        self.walked += moved
        self.rest = max(self.rest - dt, 0.0)
        if self.length - self.along < 0.02 and self.speed < 0.1 and self.walk.behaviour != "waiting":
            self._turn_back()
        self._turn(dt)
        right_of_way.place(self.name, self.claim())

    def state(self) -> State:
        """Where it is, with the mesh of this phase of its gait."""
        heading = self.ahead * self.way
        xy = self.start + self.ahead * (self.along if self.way > 0 else self.length - self.along)
        looks = self.looks
        if self.speed > 0.05:
            cycle = self.phase + self.walked / self.stride
            looks = replace(looks, asset=f"{looks.asset}/{int(cycle * GAIT_PHASES) % GAIT_PHASES}")
        return State(self.name, looks, xy, self.yaw, heading * self.speed, self.yaw_rate)

    def _find_crossings(self, roads: Sequence[Road]) -> list[tuple[float, float]]:
        """Stretches of the walk that lie on a road [m from its start]."""
        s = np.arange(0.0, self.length, 0.1)
        on = np.concatenate([[False], on_road(self.start + s[:, None] * self.ahead, roads), [False]])
        flips = np.flatnonzero(on[1:] != on[:-1])
        return [(0.1 * a, 0.1 * b) for a, b in zip(flips[::2], flips[1::2], strict=True)]

    def _stretches(self) -> list[tuple[float, float]]:
        """The crossings along the present direction."""
        if self.way > 0:
            return self._crossings
        return [(self.length - b, self.length - a) for a, b in reversed(self._crossings)]

    def _limit(self, right_of_way: RightOfWay) -> float:
        """How far it may walk on [m]; a road is stepped on only when its ground is free."""
        for start, end in self._stretches():
            if self.along >= end or self.along > start - WAIT_AT / 2 or self.allowed == (start, end):
                continue
            near = self.along > start - WAIT_AT - 1.0 and self.rest == 0
            at_ease = self.waited < PATIENCE
            if near and right_of_way.may_step(self._ground(self.along, end), at_ease):
                self.allowed = start, end
                continue
            return start - WAIT_AT - self.along
        return self.length - self.along

    def claim(self) -> Claim:
        """The rest of the road it is crossing, or the place where it stands."""
        end = self.along
        for start, stop in self._stretches():
            inside = start - WAIT_AT / 2 < self.along < stop
            if inside or (self.allowed == (start, stop) and self.along < stop):
                end = stop
        return self._ground(self.along, end)

    def _ground(self, start: float, end: float) -> Claim:
        s = np.arange(start, end + STEP, STEP)
        s = s if self.way > 0 else self.length - s
        return Claim(self.start + s[:, None] * self.ahead, RADIUS, walker=True)

    def _turn_back(self) -> None:
        self.way, self.along, self.speed = -self.way, self.length - self.along, 0.0
        self.rest, self.allowed = REST, None

    def _turn(self, dt: float) -> None:
        heading = np.arctan2(*(self.ahead * self.way)[::-1])
        change = float(np.clip(wrap_angle(heading - self.yaw), -TURNING * dt, TURNING * dt))
        self.yaw += change
        self.yaw_rate = change / dt
