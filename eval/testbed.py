"""Testbed: the simulator with perception inside `step`, scored against the truth."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter
from typing import Any, cast

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils import EzPickle

from datmo.arrays import U8
from datmo.config import DatmoConfig
from datmo.messages import Frame, Relief, Truth
from datmo.pipeline import Datmo
from eval.metrics.ground import grid_centres
from eval.score import Metric, Scorer
from eval.view import BirdsEye
from scenarios.spec import Scenario
from sim.env import LidarEnv, Observation, Step


class Testbed(gym.Wrapper[Observation, Any, Observation, Any], EzPickle):
    """Runs `Datmo` on every scan of a `LidarEnv` and scores each stage.

    Observation and action are the `LidarEnv`'s. Reward: the step's perception score in [0, 1],
    the mean of ground.f1 x (1 - leak), the detection F1 and 1 - gospa / gospa of no tracks, parts
    without data left out. `info` adds to `scan` and `truth`: `relief` (Relief), `frame` (Frame)
    and `metrics` (of this step, without times).

    Args:
        env: a `LidarEnv`, wrapped or not.
        config: the configuration of every stage.
    """

    __test__ = False  # pytest would otherwise collect the name

    def __init__(self, env: gym.Env[Observation, Any], config: DatmoConfig | None = None) -> None:
        EzPickle.__init__(self, env, config)
        gym.Wrapper.__init__(self, env)
        self.config = config or DatmoConfig()
        self._centres = grid_centres()
        self._begin()

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """A new episode: fresh world, fresh perception, fresh scores."""
        obs, info = self.env.reset(seed=seed, options=options)
        self._begin()
        self._judge(info)
        return obs, info

    def step(self, action: Any) -> Step:
        """Traffic, sweep, perception, scores."""
        start = perf_counter()
        obs, _, terminated, truncated, info = self.env.step(action)
        reward = self._judge(info)
        self._note_times(perf_counter() - start)
        return obs, reward, terminated, truncated, info

    def render(self) -> U8 | None:
        """The bird's-eye picture (h, w, 3): cloud by class, true boxes, tracks with tails."""
        if self.render_mode is None:
            return cast("U8 | None", self.env.render())  # says how to ask for pictures
        return self._view.draw(self._frame, self._truth)

    @property
    def spec(self) -> EnvSpec | None:  # type: ignore[override]
        """The id this test-bed was made from; the wrapper is part of it, not an addition."""
        return self.env.spec

    @property
    def lidar(self) -> LidarEnv:
        """The simulator inside."""
        assert isinstance(self.env.unwrapped, LidarEnv)
        return self.env.unwrapped

    def result(self) -> list[Metric]:
        """Every metric over the scans so far."""
        return self._scorer.result()

    def detail(self) -> dict[str, Any]:
        """What stands beside the metrics: by range, by class, by event."""
        return self._scorer.detail()

    def _begin(self) -> None:
        self._datmo = Datmo(self.config)
        self._scorer = Scorer()
        self._view = BirdsEye()

    def _judge(self, info: dict[str, Any]) -> float:
        relief: Relief = self.lidar.relief(self._centres)
        self._frame: Frame = self._datmo.step(info["scan"])
        self._truth: Truth = info["truth"]
        start = perf_counter()
        nis = {track: value for track, (value, _) in self._datmo.tracker.nis.items()}
        metrics = self._scorer.add(self._frame, self._truth, relief, nis)
        self._view.follow(self._frame)
        self._score_ms = (perf_counter() - start) * 1e3
        info.update(relief=relief, frame=self._frame, metrics=metrics)
        return self._scorer.reward(metrics)

    def _note_times(self, seconds: float) -> None:
        stage = self._frame.milliseconds
        self._scorer.add_times(
            {
                "speed.step_ms": seconds * 1e3,
                "speed.cast_ms": self.lidar.milliseconds["cast"],
                "speed.ground_ms": stage["ground"],
                "speed.detect_ms": stage["clusters"] + stage["boxes"],
                "speed.track_ms": stage["tracks"],
                "speed.score_ms": self._score_ms,
            }
        )


def make_testbed(
    scenario: str | Path | Scenario = "rough-crossing",
    render_mode: str | None = None,
    ground: str | None = None,
    config: DatmoConfig | None = None,
) -> Testbed:
    """The test-bed of a scenario; what `gym.make("eval:datmo/Testbed-v0")` calls.

    Args:
        scenario: a name of the catalogue, a file, or a `Scenario`.
        render_mode: None or "rgb_array".
        ground: the ground method by name; None keeps the configuration's.
        config: the configuration of every stage.
    """
    config = config or DatmoConfig()
    if ground is not None:
        config = config.with_ground(ground)
    return Testbed(LidarEnv(scenario, render_mode), config)
