"""A scenario from its name or file, and back to text that replays it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from datmo.errors import ScenarioError
from scenarios.problems import sentences
from scenarios.read import Source, find, merge, parse, read_chain
from scenarios.spec import Scenario


def load(name_or_path: str | Path, overrides: Mapping[str, str] | None = None) -> Scenario:
    """The scenario of a name or a YAML file, with its parents merged in and `extends` then cleared.

    Args:
        name_or_path: a name of the catalogue, or a file.
        overrides: dotted keys to YAML values, as `--set terrain.grade=0.06` gives them; elements of
            lists by number (`pedestrians.0.speed`), bounds as `expect.ground.f1.min`.

    Raises:
        ScenarioError: with file, key, value, rule and remedy of every problem, one a line.
    """
    path = find(name_or_path)
    chain = read_chain(path)
    if "name" not in chain[0].says:
        raise ScenarioError(f"{path}: name is missing; add one, e.g. 'name: {path.name.split('.')[0]}'")
    says: Any = {}
    for source in reversed(chain):
        says = merge(says, source.says)
    says = {**says, "extends": None}
    spoken: dict[str, Any] = {}
    for key, text in (overrides or {}).items():
        place = _place(key)
        value = parse(text, f"--set {key}={text}")
        says = _set(says, place, value, key)
        spoken = _set(spoken, place, value, key, loose=True)
    return _validated(says, [Source("--set", spoken), *chain] if spoken else chain)


def dump(scenario: Scenario) -> str:
    """YAML that `load` reads back to an equal scenario."""
    return yaml.safe_dump(scenario.model_dump(mode="json"), sort_keys=False, allow_unicode=True, width=100)


def _validated(says: Mapping[str, Any], chain: list[Source]) -> Scenario:
    """JSON is the strict reading of YAML: no text for numbers, but lists for tuples; dates are text."""
    try:
        return Scenario.model_validate_json(json.dumps(says, default=str), strict=True)
    except ValidationError as error:
        problems = sentences(error.errors(include_url=False), chain)
        raise ScenarioError("\n".join(problems)) from None


def _place(key: str) -> list[str]:
    parts = key.split(".")
    if not all(parts):
        raise ScenarioError(f"--set {key!r}: a key is names joined by dots; write e.g. terrain.grade=0.06")
    if parts[0] == "extends":
        raise ScenarioError("--set extends: a scenario is extended in its file only; write a file")
    if parts[0] == "expect" and len(parts) > 2 and parts[-1] in ("min", "max"):
        return ["expect", ".".join(parts[1:-1]), parts[-1]]  # metric names hold dots
    return parts


def _set(tree: Any, place: list[str], value: Any, key: str, loose: bool = False) -> Any:
    """A copy of `tree` with `value` at `place`; a number indexes a list."""
    if not place:
        return value
    head, rest = place[0], place[1:]
    if isinstance(tree, list):
        if not (head.isdigit() and int(head) < len(tree)):
            raise ScenarioError(f"--set {key}: {head!r} is no element of {len(tree)}; number them from 0")
        return [_set(v, rest, value, key, loose) if i == int(head) else v for i, v in enumerate(tree)]
    if tree is None:
        tree = {}
    if not isinstance(tree, dict):
        raise ScenarioError(f"--set {key}: {head!r} lies under the plain value {tree!r}; set that instead")
    name: int | str = int(head) if loose and head.isdigit() else head
    return {**tree, name: _set(tree.get(name), rest, value, key, loose)}
