"""The scenarios that ship with the project: names, tags and summaries."""

from __future__ import annotations

from pathlib import Path

from scenarios.load import load
from scenarios.read import find, names

__all__ = ["names", "path", "summaries", "tagged"]


def path(name: str) -> Path:
    """The file of a scenario.

    Raises:
        ScenarioError: the name is unknown; with the nearest ones.
    """
    return find(name)


def tagged(tag: str) -> tuple[str, ...]:
    """Names of the scenarios that carry a tag, sorted."""
    return tuple(name for name in names() if tag in load(name).tags)


def summaries() -> dict[str, str]:
    """Each name with what happens in one line."""
    return {name: load(name).summary for name in names()}
