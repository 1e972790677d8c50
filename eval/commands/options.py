"""Options that several commands share, so that each means the same everywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from datmo.errors import ConfigError


def known_method(name: str | None) -> str | None:
    """The name of a ground method, checked before any work begins.

    Raises:
        ConfigError: there is no such method.
    """
    if name is not None:
        from datmo.config import DatmoConfig

        DatmoConfig().with_ground(name)
    return name


Scenario = Annotated[str, typer.Argument(metavar="SCENARIO", help="A name (see datmo list) or a YAML file.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of the episode.")]
Frames = Annotated[
    int | None, typer.Option("--frames", min=1, help="Scans to play; the whole scenario by default.")
]
GroundMethod = Annotated[
    str | None,
    typer.Option(
        "--ground", metavar="METHOD", callback=known_method, help="Ground method; default: default."
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Change the scenario, e.g. terrain.grade=0.1; repeatable."
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Overwrite what --out names.")]
Workers = Annotated[
    int, typer.Option("--workers", min=1, help="Processes; the result does not depend on it.")
]
OutFolder = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Where the result goes.")]
Picture = Annotated[
    Path | None, typer.Option("--picture", metavar="PNG", help="Also draw the bird's-eye picture.")
]


def settings(pairs: list[str] | None) -> dict[str, str]:
    """KEY=VALUE pairs as a mapping.

    Raises:
        ConfigError: a pair has no "=".
    """
    found: dict[str, str] = {}
    for pair in pairs or []:
        key, sign, value = pair.partition("=")
        if not sign or not key.strip():
            raise ConfigError(f"--set {pair!r} is no KEY=VALUE; write e.g. --set terrain.grade=0.1")
        found[key.strip()] = value
    return found
