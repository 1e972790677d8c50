"""Who takes part in the ground benchmark: our methods by name, and two published peers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from datmo.errors import ConfigError, nearest
from datmo.ground import METHODS, GroundConfig, GroundSegmenter
from datmo.messages import Ground, Scan

Step = Callable[[Scan], Ground]


@dataclass(frozen=True)
class Contestant:
    """A method that takes part.

    Attributes:
        name: in tables. fresh: makes a step that has seen nothing yet; the same step again is one
            that goes on with a sequence. ours: whether it is of this project, and so gives heights.
    """

    name: str
    fresh: Callable[[], Step]
    ours: bool = True


def ours(method: str, overrides: Mapping[str, Any] | None = None, name: str | None = None) -> Contestant:
    """One of our methods, with fields of `GroundConfig` changed where `overrides` says so."""
    config = GroundConfig.model_validate({"method": method, **(overrides or {})})

    def fresh() -> Step:
        segmenter = GroundSegmenter(config)
        return lambda scan: segmenter.step(scan.points)

    return Contestant(name or method, fresh)


def check_methods(methods: Sequence[str]) -> list[str]:
    """The methods, if all are known.

    Raises:
        ConfigError: one is not, or there is none.
    """
    if not methods:
        raise ConfigError(f"methods is empty; a benchmark has at least one; give e.g. {METHODS[0]}")
    for method in methods:
        if method not in METHODS:
            raise ConfigError(f"ground method {method!r} is not known; {nearest(method, METHODS)}")
    return list(methods)


def best() -> str:
    """The method that a user gets who asks for none in particular."""
    return "default" if "default" in METHODS else METHODS[0]
