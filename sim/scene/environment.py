"""The highway-env environment of a scenario, its configuration checked: highway-env itself takes any key."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from numbers import Real
from typing import Any

import gymnasium as gym
from gymnasium.spaces import Discrete, Space

from datmo.errors import ScenarioError, nearest
from scenarios.spec import Scenario

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import highway_env  # noqa: F401  # registers its environments
    from highway_env.envs.common import action as actions


@contextmanager
def quiet() -> Iterator[None]:
    """highway-env warns that its ids are out of date and that its own arguments are deprecated."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def make(scenario: Scenario) -> Any:
    """The highway-env environment of a scenario, configured, or None.

    Raises:
        ScenarioError: it is unknown, has no such configuration key, or wants another type of value there.
    """
    name, config = scenario.traffic.environment, scenario.traffic.config
    if name is None:
        return None
    known = [key for key, spec in gym.registry.items() if "highway_env." in str(spec.entry_point)]
    if name not in known:
        raise ScenarioError(
            f"traffic.environment = {name!r} is no environment of highway-env; {nearest(name, known)}"
        )
    with quiet():
        env: Any = gym.make(name, disable_env_checker=True).unwrapped
        check(config, env.config, f"of {name}", "traffic.config")
        env.configure({**config, "observation": {"type": "AttributesObservation", "attributes": []}})
        env.define_spaces()
    return env


def action_space(scenario: Scenario) -> Space[Any]:
    """`Discrete(1)` where the ego drives or stands by itself, else highway-env's action space."""
    if scenario.ego.control != "agent":
        return Discrete(1)
    env = make(scenario)
    if env is None:
        raise ScenarioError("ego.control = 'agent' needs traffic.environment; choose a highway-env id")
    space: Space[Any] = env.action_space
    return space


def check(config: Mapping[str, Any], defaults: Mapping[str, Any], whose: str, path: str) -> None:
    """Refuse keys that the `defaults` of highway-env do not have, and values of another type than theirs.

    Args:
        whose: "of " what the keys are, and path: where they stand, both for the message.

    Raises:
        ScenarioError: names the key, the rule and the nearest key.
    """
    for key, value in config.items():
        if key not in defaults:
            raise ScenarioError(f"{path}.{key} is no key {whose}; {nearest(key, defaults)}")
        if key == "observation":
            raise ScenarioError(f"{path}.observation has no effect: the lidar observes; leave it out")
        if key in ("action", "action_config"):
            _check_action(value, f"{path}.{key}")
        elif not _fits(value, defaults[key]):
            raise ScenarioError(
                f"{path}.{key} = {value!r} must be of the type of highway-env's own {defaults[key]!r}"
            )


def _check_action(config: Any, path: str) -> None:
    """The same for an action: its keys are the arguments of its class."""
    if not isinstance(config, Mapping):
        raise ScenarioError(f"{path} = {config!r} must be a mapping; give its type and arguments")
    known = {
        name: kind
        for name, kind in inspect.getmembers(actions, inspect.isclass)
        if issubclass(kind, actions.ActionType) and kind is not actions.ActionType
    }
    name = config.get("type")
    if name not in known:
        raise ScenarioError(
            f"{path}.type = {name!r} is no action of highway-env; {nearest(str(name), known)}"
        )
    arguments = inspect.signature(known[name]).parameters
    named = {key: p.default for key, p in arguments.items() if key != "env" and p.kind is not p.VAR_KEYWORD}
    given = {key: value for key, value in config.items() if key != "type"}
    nothing = {key: None if default is inspect.Parameter.empty else default for key, default in named.items()}
    check(given, nothing, f"of {name}", path)


def _fits(value: Any, default: Any) -> bool:
    """Whether a value can stand for a default: numbers for numbers, lists for lists, anything for None."""
    if default is None:
        return True
    if isinstance(default, bool) or isinstance(value, bool):
        return isinstance(default, bool) and isinstance(value, bool)
    if isinstance(default, Real):
        return isinstance(value, Real)
    if isinstance(default, list | tuple):
        return isinstance(value, list | tuple)
    return isinstance(value, type(default))
