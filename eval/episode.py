"""One episode of an environment, scan by scan."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gymnasium as gym

from datmo.errors import ConfigError
from scenarios.spec import Scenario

IDLE = 1
"""highway-env's DiscreteMetaAction for "go on as you are"; an autopilot takes only 0."""


def scans_to_play(scenario: Scenario, frames: int | None) -> int:
    """How many scans a run plays: `frames`, at most the scenario's.

    Raises:
        ConfigError: `frames` is below 1.
    """
    if frames is not None and frames < 1:
        raise ConfigError(f"frames is {frames}; a run has at least 1; give a positive number")
    return scenario.scans if frames is None else min(frames, scenario.scans)


def episode(env: gym.Env[Any, Any], scenario: Scenario, seed: int, scans: int) -> Iterator[dict[str, Any]]:
    """The `info` of each scan, reset's first; ends early where the episode does.

    Args:
        env: a LidarEnv or a Testbed of `scenario`. seed: of the episode. scans: at most this many.

    Raises:
        ConfigError: the seed is negative.
    """
    if seed < 0:
        raise ConfigError(f"seed is {seed}; seeds are not negative; give 0 or more")
    action = IDLE if scenario.ego.control == "agent" else 0
    _, info = env.reset(seed=seed)
    yield info
    for _ in range(scans - 1):
        _, _, terminated, truncated, info = env.step(action)
        yield info
        if terminated or truncated:
            return
