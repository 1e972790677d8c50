from __future__ import annotations

import pickle  # noqa: TID251 - what spawned vector environments do

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from datmo.errors import ScenarioError, SimulationError
from scenarios.spec import Scenario
from sim.env import LidarEnv


def test_checker_passes_with_rendering(tiny: Scenario) -> None:
    env = gym.make("sim:datmo/Lidar-v0", scenario=tiny, render_mode="rgb_array")
    check_env(env.unwrapped)
    env.close()


@pytest.mark.long  # as the plain install of `test_packaging`, warnings being errors
def test_the_module_id_needs_no_import_of_ours() -> None:
    import subprocess
    import sys

    code = "import gymnasium as gym; gym.make('sim:datmo/Lidar-v0', scenario='rough-crossing').close()"
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)


def test_an_episode_has_its_scans_and_stamps(tiny: Scenario) -> None:
    env = LidarEnv(tiny)
    _, info = env.reset(seed=3)
    stamps, truncated = [info["scan"].stamp], False
    while not truncated:
        obs, reward, terminated, truncated, info = env.step(0)
        assert obs in env.observation_space
        assert reward == 0
        assert not terminated
        stamps.append(info["scan"].stamp)
    np.testing.assert_allclose(stamps, np.arange(7) / 10)
    assert len(stamps) == tiny.scans


def test_the_range_image_is_the_scan(tiny: Scenario) -> None:
    obs, info = LidarEnv(tiny).reset(seed=1)
    scan = info["scan"]
    assert obs["range"].shape == (64, 2083)
    assert np.count_nonzero(obs["range"]) == len(scan)
    counts = np.count_nonzero(obs["range"], axis=1)
    assert counts.tolist() == np.bincount(scan.ring, minlength=64).tolist()


@pytest.mark.long
def test_one_seed_one_world(tiny: Scenario) -> None:
    def play(seed: int) -> list[bytes]:
        env = LidarEnv(tiny)
        _, info = env.reset(seed=seed)
        infos = [info] + [env.step(0)[4] for _ in range(2)]
        return [i["scan"].points.tobytes() + i["truth"].height.tobytes() for i in infos]

    first = play(5)
    play(6)
    assert play(5) == first
    assert play(6) != first


def test_a_closed_environment_may_be_closed_and_reset_again(tiny: Scenario) -> None:
    env = LidarEnv(tiny)
    with pytest.raises(SimulationError, match="reset"):
        env.step(0)
    env.reset(seed=0)
    env.close()
    env.close()
    env.reset(seed=0)


def test_unknown_scenario_names_the_nearest() -> None:
    with pytest.raises(ScenarioError, match="rough-crossing"):
        LidarEnv("rough-crosing")


@pytest.mark.parametrize("module", ["sim:datmo/Lidar-v0", "eval:datmo/Testbed-v0"])
def test_a_pickled_environment_is_made_anew_and_plays_the_same(tiny: Scenario, module: str) -> None:
    env = gym.make(module, scenario=tiny, render_mode="rgb_array").unwrapped
    first = env.reset(seed=2)[1]["scan"]
    env.step(0)
    again = pickle.loads(pickle.dumps(env))  # noqa: S301 - our own bytes
    assert again.render_mode == "rgb_array"
    assert again.scenario == tiny
    assert again.reset(seed=2)[1]["scan"] == first
    assert again.render().shape == (800, 800, 3)


def test_seeding_follows_gymnasium(tiny: Scenario) -> None:
    """A seed holds from then on: resets without one go on with the same generator."""
    env = LidarEnv(tiny)
    told = [env.reset(seed=6)[1]["scan"], env.reset()[1]["scan"]]
    again = [env.reset(seed=6)[1]["scan"], env.reset()[1]["scan"]]
    assert told == again
    assert told[0] != told[1]
