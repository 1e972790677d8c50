"""What a scenario says of an environment's configuration, held against its own: highway-env takes any key."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from numbers import Real
from typing import Any

from datmo.errors import ScenarioError, nearest


def check(
    config: Mapping[str, Any], defaults: Mapping[str, Any], action: type[Any], whose: str, path: str
) -> None:
    """Refuse keys that the `defaults` of highway-env do not have, and values of another type than theirs.

    Args:
        action: what the classes of actions come from.
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
            _check_action(value, action, f"{path}.{key}")
        elif not _fits(value, defaults[key]):
            raise ScenarioError(
                f"{path}.{key} = {value!r} must be of the type of highway-env's own {defaults[key]!r}"
            )


def _kinds(base: type[Any]) -> dict[str, type[Any]]:
    """The classes that come from a class, by name."""
    found = {kind.__name__: kind for kind in base.__subclasses__()}
    return found | {name: kind for one in found.values() for name, kind in _kinds(one).items()}


def _check_action(config: Any, action: type[Any], path: str) -> None:
    """The same for an action: its keys are the arguments of its class."""
    actions = _kinds(action)
    if not isinstance(config, Mapping):
        raise ScenarioError(f"{path} = {config!r} must be a mapping; give its type and arguments")
    name = config.get("type")
    if name not in actions:
        raise ScenarioError(
            f"{path}.type = {name!r} is no action of highway-env; {nearest(str(name), actions)}"
        )
    arguments = inspect.signature(actions[name]).parameters
    named = {key: p.default for key, p in arguments.items() if key != "env" and p.kind is not p.VAR_KEYWORD}
    given = {key: value for key, value in config.items() if key != "type"}
    nothing = {key: None if default is inspect.Parameter.empty else default for key, default in named.items()}
    check(given, nothing, action, f"of {name}", path)


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
