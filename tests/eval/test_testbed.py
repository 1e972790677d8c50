from __future__ import annotations

import copy

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from datmo.errors import ConfigError
from datmo.messages import Frame, Relief, Scan, Truth
from eval.testbed import Testbed, make_testbed
from scenarios.expect import UNITS
from scenarios.spec import Scenario


def made(tiny: Scenario, **options: object) -> gym.Env:
    return gym.make("eval:datmo/Testbed-v0", scenario=tiny, render_mode="rgb_array", **options)


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:.*is different from the unwrapped version:UserWarning")
def test_checker_passes_on_the_wrapper_that_it_is(tiny: Scenario) -> None:
    env = made(tiny)
    check_env(env)
    env.close()


def test_a_step_carries_every_message(tiny: Scenario) -> None:
    env = made(tiny)
    env.reset(seed=7)
    obs, reward, _, _, info = env.step(0)
    assert obs in env.observation_space
    assert 0 <= reward <= 1
    for name, kind in {
        "scan": Scan,
        "truth": Truth,
        "relief": Relief,
        "frame": Frame,
        "metrics": dict,
    }.items():
        assert isinstance(info[name], kind)
    assert info["frame"].scan == info["scan"]
    assert not any(name.startswith("speed.") for name in info["metrics"])
    env.close()


def test_the_result_writes_every_name(tiny: Scenario) -> None:
    env = make_testbed(tiny)
    env.reset(seed=1)
    for _ in range(2):
        env.step(0)
    result = {m.name: m for m in env.result()}
    assert list(result) == list(UNITS)
    assert {name: m.unit for name, m in result.items()} == UNITS
    assert result["ground.f1"].value > 0.9
    assert result["speed.step_ms"].value > 0
    assert result["recovery.rate"].value is None


def test_the_spec_makes_the_same_thing_again(tiny: Scenario) -> None:
    env = made(tiny)
    again = env.spec.make()
    wrappers, layer = [], again
    while isinstance(layer, gym.Wrapper):
        wrappers.append(type(layer))
        layer = layer.env
    assert wrappers.count(Testbed) == 1


def test_the_picture_is_a_picture(tiny: Scenario) -> None:
    env = made(tiny)
    env.reset(seed=0)
    image = env.render()
    assert image.dtype == np.uint8
    assert image.ndim == 3
    assert image.std() > 5


def test_unknown_ground_names_the_choices(tiny: Scenario) -> None:
    with pytest.raises(ConfigError, match="'z' or 'zl' or 'zli'"):
        make_testbed(tiny, ground="zz")


def test_copies_restore_the_arguments(tiny: Scenario) -> None:
    env = make_testbed(tiny, ground="z-se")
    twin = copy.deepcopy(env)
    assert twin.config == env.config
    np.testing.assert_array_equal(env.reset(seed=2)[0]["range"], twin.reset(seed=2)[0]["range"])


@pytest.mark.long
def test_a_video_is_recorded(tiny: Scenario, tmp_path) -> None:
    pytest.importorskip("moviepy")
    env = gym.wrappers.RecordVideo(made(tiny), str(tmp_path / "videos"), episode_trigger=lambda _: True)
    env.reset(seed=0)
    truncated = False
    while not truncated:
        truncated = env.step(0)[3]
    env.close()
    videos = list(tmp_path.glob("videos/*.mp4"))
    assert len(videos) == 1
    assert videos[0].stat().st_size > 10_000
