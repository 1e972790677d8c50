"""LidarEnv: the world and the sensor as a Gymnasium environment; it knows no perception."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Box, Dict, Space
from gymnasium.utils import EzPickle

from datmo.arrays import F32, F64, U8
from datmo.errors import SimulationError
from datmo.messages import Relief, Scan, Truth
from scenarios.load import load
from scenarios.spec import Scenario
from sim.hidden import Hidden, HiddenIntervals
from sim.picture import picture
from sim.scan.sweep import Lidar
from sim.scene.motion import Poses
from sim.scene.terrain import Terrain
from sim.scene.world import World

Observation = dict[str, F32]
Step = tuple[Observation, float, bool, bool, dict[str, Any]]


class LidarEnv(gym.Env[Observation, Any], EzPickle):
    """A lidar on a vehicle in traffic over terrain.

    Observation: `range` (rings, columns) f32 [m], row 0 the top ring, columns in firing order from
    the rear, clockwise from above, 0 where nothing returned; `intensity` (rings, columns) f32, 0..1.
    Action: `Discrete(1)` on autopilot; highway-env's own action space with `control: agent`.
    Reward: 0; the `Testbed` scores. `info`: `scan` (Scan) and `truth` (Truth).
    The episode ends (`truncated`) at the scenario's duration, or (`terminated`) when the ego
    crashes or arrives.

    Args:
        scenario: a name of the catalogue, a file, or a `Scenario`.
        render_mode: None or "rgb_array", the bird's-eye picture.

    Raises:
        ScenarioError: the scenario is unknown or wrong.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - Gymnasium declares it so
        "render_modes": ["rgb_array"],
        "render_fps": 10,
    }

    def __init__(
        self, scenario: str | Path | Scenario = "rough-crossing", render_mode: str | None = None
    ) -> None:
        EzPickle.__init__(self, scenario, render_mode)
        self.scenario = scenario if isinstance(scenario, Scenario) else load(scenario)
        self.render_mode = render_mode
        self.metadata = {**type(self).metadata, "render_fps": round(self.scenario.rate)}
        shape = Lidar.shape(self.scenario.sensor, self.scenario.rate)
        self.observation_space: Space[Observation] = Dict(  # type: ignore[assignment]
            range=Box(0, self.scenario.sensor.range + 1, shape, np.float32),
            intensity=Box(0, 1, shape, np.float32),
        )
        self.action_space = World.actions(self.scenario)
        self.milliseconds: dict[str, float] = {}
        self._world: World | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """A new world from one seed, and its scan at time 0."""
        super().reset(seed=seed, options=options)
        world_seed, noise_seed = np.random.SeedSequence(int(self.np_random.integers(2**62))).spawn(2)
        self._world = World(self.scenario, world_seed)
        self._lidar = Lidar(
            self.scenario.sensor, self.scenario.rate, self._world.terrain, self._world.things, noise_seed
        )
        self._index = 0
        self._hidden = HiddenIntervals()
        obs, info = self._sweep(self._world.reset())
        return obs, info

    def step(self, action: Any) -> Step:
        """Play one period: traffic, then the sweep that ends with it."""
        start = perf_counter()
        world = self.world
        poses = world.advance(action)
        self._index += 1
        self.milliseconds["traffic"] = (perf_counter() - start) * 1e3
        obs, info = self._sweep(poses)
        terminated = world.crashed or world.arrived
        truncated = self._index + 1 >= self.scenario.scans
        return obs, 0.0, terminated, truncated, info

    def render(self) -> U8 | None:
        """The bird's-eye picture (h, w, 3) of the last scan: cloud by class, true boxes."""
        if self.render_mode is None:
            gym.logger.warn("render() was called without render_mode; pass render_mode='rgb_array'")
            return None
        return picture(self._scan, self._truth)

    def close(self) -> None:
        """Let go of the world; a closed environment may be reset again."""
        self._world = None

    @property
    def world(self) -> World:
        """The running world."""
        if self._world is None:
            raise SimulationError("the world does not run: no episode has begun; call reset() first")
        return self._world

    @property
    def terrain(self) -> Terrain:
        """The terrain of the running episode."""
        return self.world.terrain

    @property
    def hidden_intervals(self) -> tuple[Hidden, ...]:
        """When each actor was hidden, over the episode so far."""
        return self._hidden.intervals() if self._world is not None else ()

    def relief(self, xy: F64) -> Relief:
        """True ground at places (g, 2) [m, sensor] of the last scan, for the judge."""
        return self._lidar.relief(self._scan.T_world_sensor, xy)

    def _sweep(self, poses: Poses) -> tuple[Observation, dict[str, Any]]:
        start = perf_counter()
        scan, truth = self._lidar.sweep(poses, self._index)
        self._scan: Scan = scan
        self._truth: Truth = truth
        self._hidden.add(truth)
        distance, intensity = self._lidar.range_image()
        self.milliseconds["cast"] = (perf_counter() - start) * 1e3
        return {"range": distance, "intensity": intensity}, {"scan": scan, "truth": truth}
