"""The world of one episode: terrain, traffic, walkers and scripts, and their motion sweep by sweep."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Space

from datmo.arrays import F64
from datmo.geometry import corners_bev, overlap_bev
from datmo.messages import Kind
from scenarios.spec import Scenario
from sim.scan.units import unit
from sim.scene import clearance
from sim.scene.contact import stand
from sim.scene.curve import hermite
from sim.scene.flow import Traffic
from sim.scene.motion import Poses, edges
from sim.scene.pedestrians import Crowd
from sim.scene.roads import Road
from sim.scene.scenery.around import around as surroundings
from sim.scene.script import Script, looks_of
from sim.scene.terrain import Terrain, build_terrain
from sim.scene.traffic import action_space
from sim.scene.vehicles import State, body
from sim.scene.walkers.boxes import join, of_parked, of_things

FIRST_SCRIPT = 1
FIRST_PARKED = 10001
PHYSICS = 20.0
"""Least rate of the traffic [Hz]; a whole number of its steps fill a sweep."""

AROUND = 10.0  # the terrain reaches beyond the sensor's range by this [m]
LONGEST = 20.0  # parked vehicles are told up to this far beyond the sensor's range [m]
Area = tuple[float, float, float, float]


def spawn(seed: np.random.SeedSequence, count: int) -> list[np.random.SeedSequence]:
    """The first `count` children of a seed, the same ones at every call."""
    return [np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, i)) for i in range(count)]


def around(points: F64, margin: float) -> Area:
    """The rectangle x_min, y_min, x_max, y_max that holds points (n, 2) with a margin [m]."""
    (x0, y0), (x1, y1) = points.min(0) - margin, points.max(0) + margin
    return float(x0), float(y0), float(x1), float(y1)


def clip(roads: Sequence[Road], area: Area) -> tuple[Road, ...]:
    """The parts of roads that matter to an area: runs of at least two points in or near it."""
    x0, y0, x1, y1 = area
    parts = []
    for road in roads:
        line, near = road.centerline, road.width + AROUND
        x, y = line.T
        inside = (x > x0 - near) & (x < x1 + near) & (y > y0 - near) & (y < y1 + near)
        flips = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int)))
        runs = zip(flips[::2], flips[1::2], strict=True)
        parts += [Road(line[a:b], road.width) for a, b in runs if b - a >= 2]
    return tuple(parts)


def hits(one: State, others: Sequence[State]) -> bool:
    """Whether the box of one overlaps any other's, seen from above."""
    near = [s for s in others if np.hypot(*(s.xy - one.xy)) < (s.body.length + one.body.length) / 2 + 2]
    everyone = [one, *near]
    boxes = corners_bev(
        np.array([s.xy for s in everyone]),
        np.array([(s.body.length, s.body.width) for s in everyone]),
        np.array([s.yaw for s in everyone]),
    )
    return any(overlap_bev(boxes[0], box) > 0 for box in boxes[1:])


class World:
    """Everything that moves, and the ground it moves on. The same seed gives the same episode.

    Args:
        scenario: what is to happen.
        seed: of terrain, traffic and walkers, each with a stream of its own.

    Attributes:
        terrain: the ground. roads: clipped to it. things: that stand on it.
        parked: vehicles that stand beside the roads.
        time: of the last sweep's end [s since the first scan].
    """

    def __init__(self, scenario: Scenario, seed: np.random.SeedSequence) -> None:
        self.scenario = scenario
        ground, self._traffic_seed, *self._walker_seeds = spawn(seed, 2 + len(scenario.pedestrians))
        self._steps = int(np.ceil(PHYSICS / scenario.rate))
        self._edges = edges(unit(scenario.sensor.unit).columns(scenario.rate), 1.0 / scenario.rate)
        self.crashed = self._played = False
        self._warm_up = round(scenario.traffic.warm_up * scenario.rate)
        self._begin()
        area = around(self._traffic.reachable(scenario.duration), scenario.sensor.range + AROUND)
        self.roads = clip(self._traffic.roads, area)
        self.terrain: Terrain = build_terrain(scenario.terrain, self.roads, area, ground)
        self.things, self.parked = surroundings(scenario, self.roads, self.terrain, seed)
        self._obstacles = join([of_things(self.things), of_parked(self.parked)])
        still = np.zeros(2)
        self._standing = [
            State(FIRST_PARKED + i, body(one.asset), one.xy, one.yaw, still, 0.0)
            for i, one in enumerate(self.parked)
        ]
        clearance.check(scenario, self._scripted(0.0), self._crowd.parties)

    @staticmethod
    def actions(scenario: Scenario) -> Space[Any]:
        """The action space of a scenario, without building its world."""
        return action_space(scenario)

    def reset(self) -> Poses:
        """Play the traffic in, and return the motion of the sweep that ends at time 0."""
        if self._played:
            self._begin()
        self._played = True
        for _ in range(self._warm_up):
            self._play()
        self.crashed = False
        poses = self.advance()
        clearance.check_ego(self.scenario, self._traffic.ego_state(), self._scripted(0.0))
        self.crashed = False
        return poses

    def advance(self, action: Any = None) -> Poses:
        """The motion of the next sweep.

        Args:
            action: the agent's, where the scenario's ego is one; held for the sweep.
        """
        self._traffic.act(action)
        knots = self._play()
        values = np.array([[(*s.xy, s.yaw) for s in states] for states in knots])
        rates = np.array([[(*s.velocity, s.yaw_rate) for s in states] for states in knots])
        times = np.linspace(self._edges[0], 0.0, len(knots))
        place = hermite(times, values, rates, self._edges).swapaxes(0, 1)
        looks = [s.body for s in knots[-1]]
        size = np.array([(b.length, b.width) for b in looks])[:, None]
        upright = np.array([b.kind == Kind.PEDESTRIAN for b in looks])[:, None]
        T = stand(self.terrain, place[..., :2], place[..., 2], size[..., 0], size[..., 1], upright)
        return Poses(
            time=self._edges,
            T_world_ego=T[0],
            T_world_actor=T[1:],
            id=np.array([s.id for s in knots[-1][1:]], np.int64),
            kind=np.array([b.kind for b in looks[1:]], np.uint8),
            asset=tuple(b.asset for b in looks[1:]),
            velocity=rates[-1, 1:, :2],
        )

    @property
    def arrived(self) -> bool:
        """Whether the ego has reached the end of its road."""
        return self._traffic.arrived

    @property
    def time(self) -> float:
        """Now [s since the first scan]."""
        return self._tick / (self._steps * self.scenario.rate)

    def _begin(self) -> None:
        scenario = self.scenario
        self._traffic = Traffic(scenario, self._traffic_seed)
        self._tick = -(self._warm_up + 1) * self._steps
        self._scripts = [(Script(a), looks_of(a)) for a in scenario.actors]
        self._crowd = Crowd(scenario.pedestrians, self._traffic.roads, self._walker_seeds, self.time)
        self._crowd.place(self._traffic.way)
        self._claim_scripts()
        self._traffic.populate()

    def _play(self) -> list[list[State]]:
        """Play one period; the states (ego first) at its beginning and after each step."""
        self._traffic.refresh()
        ego, reach = self._traffic.ego_state().xy, self.scenario.sensor.range + LONGEST
        parked = [state for state in self._standing if np.hypot(*(state.xy - ego)) < reach]
        knots = [self._states() + parked]
        self._traffic.way.keep(s.id for s in knots[0])
        dt = 1.0 / (self._steps * self.scenario.rate)
        for _ in range(self._steps):
            self._claim_scripts()
            self._crowd.step(dt, self._traffic.way, self._others(), self._obstacles)
            self._traffic.step(dt)
            self._tick += 1
            knots.append(self._states() + parked)
            self.crashed = self.crashed or hits(knots[-1][0], knots[-1][1:])
        return knots

    def _states(self) -> list[State]:
        ego, *others = self._others()
        scripted, driven = others[: len(self._scripts)], others[len(self._scripts) :]
        return [ego, *scripted, *self._crowd.states(), *driven]

    def _others(self) -> list[State]:
        """Everyone but the walkers: the ego, scripts, traffic."""
        return [self._traffic.ego_state(), *self._scripted(self.time), *self._traffic.states()]

    def _scripted(self, time: float) -> list[State]:
        return [s.state(FIRST_SCRIPT + i, looks, time) for i, (s, looks) in enumerate(self._scripts)]

    def _claim_scripts(self) -> None:
        ego = self._traffic.ego_state().xy
        for i, (script, looks) in enumerate(self._scripts):
            script.watch(ego, self.time)
            self._traffic.way.place(FIRST_SCRIPT + i, script.claim(looks, self.time))
