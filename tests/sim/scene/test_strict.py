from __future__ import annotations

from typing import Any

import gymnasium as gym
import pytest

from datmo.errors import ScenarioError
from scenarios.spec import Scenario
from sim.scene.strict import check
from sim.scene.traffic import ActionType, make, quiet

META = "DiscreteMetaAction"


def scenario(environment: str = "intersection-v1", **config: Any) -> Scenario:
    return Scenario.model_validate(
        {"name": "t", "duration": 1.0, "traffic": {"environment": environment, "config": config}}
    )


def test_wrong_environments_are_refused() -> None:
    with pytest.raises(ScenarioError, match="did you mean 'intersection-v"):
        make(scenario("intersecton-v1"))


@pytest.mark.parametrize(
    ("config", "message"),
    [
        (
            {"destinaton": "o1"},
            r"config\.destinaton is no key of intersection-v1; did you mean 'destination'",
        ),
        ({"duration": "long"}, r"config\.duration = 'long' must be of the type of highway-env's own 13"),
        ({"duration": True}, "duration = True must be of the type"),
        ({"offscreen_rendering": 1}, "offscreen_rendering = 1 must be of the type"),
        ({"centering_position": 0.5}, "centering_position = 0.5 must be of the type"),
        ({"observation": {"type": "Kinematics"}}, "observation has no effect"),
        ({"action": META}, "action = 'DiscreteMetaAction' must be a mapping"),
        ({"action": {"type": "MetaAction"}}, r"action\.type = 'MetaAction' is no action.*DiscreteMetaAction"),
        ({"action": {"lateral": False}}, r"action\.type = None is no action"),
        (
            {"action": {"type": META, "latral": False}},
            r"action\.latral is no key of DiscreteMetaAction; .*'lateral'",
        ),
        ({"action": {"type": META, "lateral": "no"}}, r"action\.lateral = 'no' must be of the type"),
        (
            {"action": {"type": "MultiAgentAction", "action_config": {"type": META, "speeds": []}}},
            "speeds is no key",
        ),
    ],
)
def test_wrong_keys_and_values_are_named(config: dict[str, Any], message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        make(scenario(**config))


def test_what_is_right_is_taken() -> None:
    env = make(scenario(duration=9.5, destination="o2", action={"type": META, "target_speeds": [0, 5]}))
    assert env.config["duration"] == 9.5
    assert list(env.action_type.target_speeds) == [0, 5]


def test_every_environment_takes_its_own_configuration() -> None:
    names = [name for name, spec in gym.registry.items() if "highway_env." in str(spec.entry_point)]
    assert len(names) > 20
    for name in names:
        with quiet():
            own = gym.make(name, disable_env_checker=True).unwrapped.config
        own = {key: value for key, value in own.items() if key not in ("observation", "action")}
        check(own, own, ActionType, f"of {name}", "traffic.config")
