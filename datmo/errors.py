"""Named errors. Each message gives the value, the rule it breaks and the remedy."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

FEW = 4  # so many names are all shown


class DatmoError(Exception):
    """Base of every error the project raises on purpose."""


class MessageError(DatmoError, ValueError):
    """A message was given arrays of the wrong shape, type or range."""


class ConfigError(DatmoError, ValueError):
    """A configuration value breaks its rule."""


class ScenarioError(DatmoError, ValueError):
    """A scenario file or name is wrong."""


class CloudFileError(DatmoError, ValueError):
    """A point cloud file cannot be read."""


class OutputError(DatmoError, OSError):
    """A result cannot be written where it was asked for."""


class SimulationError(DatmoError, RuntimeError):
    """The simulated world cannot go on as the scenario asks."""


def nearest(name: str, known: Iterable[str]) -> str:
    """A phrase for an error message that offers the known names nearest to `name`, and all of a few."""
    names = sorted(known)
    close = get_close_matches(name, names, n=3, cutoff=0.4)
    guess = f"did you mean {' or '.join(repr(c) for c in close)}? " if close else ""
    every = f"choose one of {', '.join(names)}" if len(names) <= FEW or not close else ""
    return (guess + every).rstrip()
