"""Labelled clouds: scenarios played through the sensor alone and written in a known format."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

from datmo.errors import ConfigError, nearest
from datmo.messages import Scan, Truth
from eval.episode import episode
from eval.output import writing_folder
from eval.pool import run_all
from scenarios.load import dump
from scenarios.spec import Scenario
from sim.env import LidarEnv
from sim.export.semantickitti import SemanticKitti


class Writer(Protocol):
    """What a format offers: scans one by one, then what spans them."""

    def add(self, scan: Scan, truth: Truth) -> None:
        """Write one scan."""

    def close(self) -> None:
        """Write what spans the scans."""


FORMATS: dict[str, Callable[[Path], Writer]] = {"semantickitti": SemanticKitti}


@dataclass(frozen=True)
class Plan:
    """One sequence to write: an episode, or its beginning."""

    scenario: Scenario
    seed: int
    scans: int
    format: str
    folder: Path


def check_format(name: str) -> None:
    """Raise for a format that does not exist.

    Raises:
        ConfigError: with the formats that do.
    """
    if name not in FORMATS:
        raise ConfigError(f"format {name!r} is unknown; {nearest(name, FORMATS)}")


def plan(scenarios: Sequence[Scenario], frames: int, seed: int, format: str, folder: Path) -> list[Plan]:
    """The sequences that hold `frames` scans of each scenario: whole episodes of seed, seed + 1, ..."""
    jobs: list[Plan] = []
    for scenario in scenarios:
        left, episode_seed = frames, seed
        while left > 0:
            scans = min(left, scenario.scans)
            place = folder / "sequences" / f"{len(jobs):02d}"
            jobs.append(Plan(scenario, episode_seed, scans, format, place))
            left, episode_seed = left - scans, episode_seed + 1
    return jobs


def generate(
    scenarios: Sequence[Scenario],
    frames: int,
    seed: int,
    format: str,
    folder: Path,
    workers: int = 1,
    force: bool = False,
    on_done: Callable[[int], None] | None = None,
) -> list[int]:
    """Write the sequences into `folder`; the bytes do not depend on `workers`.

    An episode that ends early (the ego crashes or arrives) leaves a shorter sequence.

    Args:
        scenarios: each gets `frames` scans. frames: at least 1. seed: of the first episode.
        format: see `FORMATS`. folder: made here. workers: processes, each plays whole sequences.
        on_done: told how many sequences are done.

    Returns:
        scans in each sequence.

    Raises:
        ConfigError: the format is unknown. OutputError: `folder` exists and `force` is not set.
    """
    check_format(format)
    with writing_folder(folder, force) as beside:
        jobs = plan(scenarios, frames, seed, format, beside)
        counts = run_all(write_sequence, jobs, workers, on_done)
        for job in jobs:
            (job.folder / "scenario.yaml").write_text(
                f"# datmo generate, seed {job.seed}\n{dump(job.scenario)}", encoding="utf-8"
            )
    return counts


def write_sequence(job: Plan) -> int:
    """Play one episode and write its scans, and when each actor was hidden; returns how many scans."""
    env = LidarEnv(job.scenario)
    writer, count = FORMATS[job.format](job.folder), 0
    try:
        for info in episode(env, job.scenario, job.seed, job.scans):
            writer.add(info["scan"], info["truth"])
            count += 1
        writer.close()
        hidden = [asdict(interval) for interval in env.hidden_intervals]
        (job.folder / "hidden.json").write_text(json.dumps(hidden, indent=1) + "\n", encoding="utf-8")
    finally:
        env.close()
    return count
