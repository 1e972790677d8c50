"""YAML text to a plain mapping: where scenario files lie, how they are read and how they extend."""

from __future__ import annotations

import re
from collections.abc import Hashable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml

from datmo.errors import ScenarioError, nearest

SHELF = Path(str(files("scenarios") / "files"))
"""The folder of the scenarios that ship with the project."""

_FLOAT = re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")


class _Reader(yaml.SafeLoader):
    """Safe YAML that refuses a key given twice and reads 1e-3 as a number."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[str] = set()
        for key, _ in node.value:
            if key.value in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {key.value!r} is given twice; keep one of them", key.start_mark
                )
            if isinstance(key.value, str):
                seen.add(key.value)
        return super().construct_mapping(node, deep)


_Reader.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, list("-+0123456789."))


@dataclass(frozen=True)
class Source:
    """One file (or the command line) and what it alone says."""

    where: str
    says: dict[str, Any]


def parse(text: str, where: str) -> Any:
    """The value that a YAML text holds.

    Raises:
        ScenarioError: the text is no YAML; with its line and column.
    """
    try:
        reader = _Reader(text)
        try:
            return reader.get_single_data()
        finally:
            reader.dispose()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise ScenarioError(
            f"{where}: {place}{error.problem or error.context}; mend the YAML there"
        ) from None
    except yaml.YAMLError as error:
        raise ScenarioError(f"{where}: {error}; it must be YAML") from None


def names() -> tuple[str, ...]:
    """Names of the scenarios that ship with the project, sorted."""
    return tuple(sorted(p.stem for p in SHELF.glob("*.yaml")))


def find(name_or_path: str | Path, beside: Path | None = None) -> Path:
    """The file of a scenario, given by name or by path (relative to the folder `beside`, if given).

    Raises:
        ScenarioError: there is none; with the nearest names.
    """
    text = str(name_or_path)
    if text in names():
        return SHELF / f"{text}.yaml"
    path = (beside or Path()) / text
    if path.is_file():
        return path
    looks_like_path = isinstance(name_or_path, Path) or "/" in text or text.endswith((".yaml", ".yml"))
    if not looks_like_path:
        raise ScenarioError(f"there is no scenario {text!r}; {nearest(text, names())}")
    rule = "is a folder" if path.is_dir() else "does not exist"
    raise ScenarioError(f"scenario file {text!r} {rule}; give a .yaml file or one of {', '.join(names())}")


def read_chain(path: Path) -> list[Source]:
    """What the file says, then its parent, and so on along `extends`.

    Raises:
        ScenarioError: a file is unreadable, empty, no mapping, or extends itself.
    """
    chain: list[Source] = []
    visited: list[Path] = []
    while True:
        if path.resolve() in visited:
            raise ScenarioError(
                f"{path}: extends: it leads back to itself; end the chain at a file without it"
            )
        visited.append(path.resolve())
        says = _rooted(_read(path), path.parent)
        chain.append(Source(str(path), says))
        parent = says.get("extends")
        if parent is None:
            return chain
        if not isinstance(parent, str):
            raise ScenarioError(f"{path}: extends: {parent!r} is no name or path of a scenario; write one")
        try:
            path = find(parent, beside=path.parent)
        except ScenarioError as error:
            raise ScenarioError(f"{path}: extends: {error}") from None


def merge(parent: Any, child: Any) -> Any:
    """The child laid over the parent: mappings merge key by key, all else is replaced."""
    if isinstance(parent, dict) and isinstance(child, dict):
        return {**parent, **{k: merge(parent.get(k), v) for k, v in child.items()}}
    return child


def _rooted(says: dict[str, Any], folder: Path) -> dict[str, Any]:
    """What a file says, its terrain's file found from the folder of the scenario."""
    terrain = says.get("terrain")
    file = terrain.get("file") if isinstance(terrain, dict) else None
    path = file.get("path") if isinstance(file, dict) else None
    if not (isinstance(terrain, dict) and isinstance(file, dict) and isinstance(path, str) and path):
        return says
    return {**says, "terrain": {**terrain, "file": {**file, "path": str((folder / path).absolute())}}}


def _read(path: Path) -> dict[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{path}: cannot be read as UTF-8 text ({error}); give a YAML file") from None
    value = parse(text, str(path))
    if value is None:
        raise ScenarioError(f"{path}: the file is empty; a scenario has at least a name")
    if not isinstance(value, dict):
        raise ScenarioError(
            f"{path}: it holds a {type(value).__name__}, not a mapping; write keys, e.g. 'name: my-scenario'"
        )
    return value
