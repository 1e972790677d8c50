"""Traffic: the vehicles of one episode, the ego among them, from step to step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from datmo.arrays import F64, Bool
from scenarios.spec import Scenario
from sim.scene.autopilot import HARD, STEP, Claim, RightOfWay, braking
from sim.scene.population import Arrival, Population
from sim.scene.roads import Road
from sim.scene.traffic import EGO_ID, Driver, Highway, mirrored, state_of
from sim.scene.vehicles import State, body

EGO = "car/0"
PAST_END = 20.0  # the ego has arrived this far before the end of the road as highway-env made it [m]
CLEAR = 60.0  # no traffic this far ahead of the ego at the first scan, on its first lane [m]


class Traffic:
    """Vehicles on roads.

    At the start of each sweep `refresh`, then some times `step`. About `traffic.vehicles` are
    kept within the sensor's range; they appear and vanish beyond it only.

    Args:
        scenario: what is to happen.
        seed: of everything random here.

    Attributes:
        roads: one a lane. way: the right of way, shared with walkers and scripts.
        ego: its vehicle in highway-env. drivers: all others.
    """

    def __init__(self, scenario: Scenario, seed: np.random.SeedSequence) -> None:
        self.scenario, self.body = scenario, body(EGO)
        rng = np.random.default_rng(seed)
        self._highway = Highway(scenario, int(seed.generate_state(1)[0]), rng)
        self._lanes = self._highway.lanes
        self.roads = tuple(Road(lane.line, lane.width) for lane in self._lanes.values())
        self.way = RightOfWay()
        self.drivers: list[Driver] = []
        self.ego = self._highway.ego(self.body)
        self._highway.road.vehicles.append(self.ego)
        count, reach = scenario.traffic.vehicles, scenario.sensor.range
        self._population = Population(self._lanes, self._highway.limits, self.way, count, reach, rng)

    def populate(self) -> None:
        """The vehicles of the start: within range of the ego's way, and those that come next."""
        self._claim_ego()
        direction = self._lanes[self._highway.first].direction(0.0)
        self._add(self._population.begin(self._highway.start, direction, self._clear()))

    def refresh(self) -> None:
        """Vehicles vanish far off, and new ones appear out of the sensor's range."""
        centre = self.ego_state().xy
        distance = [float(np.hypot(*(mirrored(d.position) - centre))) for d in self.drivers]
        kept = [d for d, r in zip(self.drivers, distance, strict=True) if not self._population.gone(r)]
        if len(kept) < len(self.drivers):
            self.drivers = kept
            self._highway.road.vehicles = [self.ego, *kept]
        waiting = sum(self._population.waiting(r) for r in distance)
        inside = len(distance) - waiting
        self._add(self._population.refill(centre, inside, waiting, self._clear()))

    def step(self, dt: float) -> None:
        """Play `dt` seconds."""
        road = self._highway.road
        road.act()
        self._claim_ego()
        everyone = [*self.drivers, self.ego] if isinstance(self.ego, Driver) else self.drivers
        chosen = self.way.decide([d.mover(d is self.ego) for d in everyone], dt)
        for driver in everyone:
            driver.drive(chosen[driver.name])
        road.step(dt)

    def act(self, action: Any) -> None:
        """Hand an agent's action to highway-env."""
        if self.scenario.ego.control == "agent" and action is not None:
            self._highway.env.action_type.act(action)

    def states(self) -> list[State]:
        """All vehicles but the ego, by age."""
        return [state_of(d, d.name, d.body) for d in self.drivers]

    def ego_state(self) -> State:
        """The ego."""
        return state_of(self.ego, EGO_ID, self.body)

    def reachable(self, duration: float) -> F64:
        """Points (n, 2) that the ego may come to within `duration` [m, world]."""
        ego, start = self.scenario.ego, self._highway.start
        reach = self._highway.top_speed(self.ego, ego.speed) * duration + 10.0
        if isinstance(self.ego, Driver):
            points = self.ego.course.points
            first = int(np.argmin(np.hypot(*(points - start).T)))
            return points[first : first + max(int(reach / STEP), 2)]
        points = np.concatenate([lane.line for lane in self._lanes.values()])
        near = points[np.hypot(*(points - start).T) < reach]
        return start[None] if ego.control == "parked" else np.vstack([start, near])

    @property
    def arrived(self) -> bool:
        """Whether the ego has reached the end of the road as highway-env made it."""
        lane = self._lanes[self.ego.lane_index]
        if not lane.leaving or lane.key == self._highway.first:
            return False
        along = self.ego.lane.local_coordinates(self.ego.position)[0]
        return bool(along >= lane.length - lane.added - PAST_END)

    def _add(self, arrivals: Sequence[Arrival]) -> None:
        made = [self._highway.drive(arrival) for arrival in arrivals]
        self.drivers += made
        self._highway.road.vehicles += made

    def _clear(self) -> Bool:
        """The ego's first lane from behind it on: what it meets there early is the scenario's to say."""
        arc = self.ego.lane.local_coordinates(self.ego.position)[0]
        ahead = self.scenario.ego.speed * self.scenario.traffic.warm_up + CLEAR
        return self._population.clear(self._highway.first, arc - 30, arc + ahead)

    def _claim_ego(self) -> None:
        """An ego that does not ask claims its body and its brake, straight ahead."""
        if isinstance(self.ego, Driver):
            return
        ego = self.ego_state()
        half = ego.body.length / 2
        ahead = np.arange(-half, half + braking(abs(float(self.ego.speed)), HARD), STEP)
        points = ego.xy + ahead[:, None] * np.array([np.cos(ego.yaw), np.sin(ego.yaw)])
        self.way.place(EGO_ID, Claim(points, ego.body.width / 2))
