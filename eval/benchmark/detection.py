"""What detection reaches on simulated episodes, and what each idea of it brings."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from datmo.config import DatmoConfig
from datmo.errors import ConfigError
from eval.benchmark.detection_table import Goal, goal_table, goals, tables
from eval.benchmark.portrait_plot import plot
from eval.benchmark.portraits import Portrait, portraits
from eval.benchmark.sightings import Job, Sighting, detect
from eval.benchmark.table import Rows, markdown
from eval.facts import hardware, versions
from eval.output import writing_folder
from eval.pool import run_all
from scenarios.load import load

ABLATIONS: Mapping[str, Mapping[str, Any]] = {
    "feedback of the tracker": {
        "split": {"enabled": False}, "carry": {"enabled": False}, "merge": {"enabled": False},
    },
    "merging": {"merge": {"enabled": False}},
    "splitting": {"split": {"enabled": False}},
    "carrying to the stamp": {"carry": {"enabled": False}},
    "whole boxes": {"boxes": {"complete": {"kinds": ()}}},
    "cells that grow with range": {"clusters": {"grid": "plain"}},
    "closeness (area instead)": {"boxes": {"criterion": "area"}},
}  # fmt: skip
"""Settings, stage by stage, that switch one idea off."""


@dataclass(frozen=True)
class Result:
    """What one configuration reached."""

    name: str
    rows: list[Sighting]

    @property
    def goals(self) -> list[Goal]:
        """See `eval.benchmark.detection_table.goals`."""
        return goals(self.rows)


def changed(settings: Mapping[str, Any]) -> DatmoConfig:
    """The defaults with some settings of some stages changed."""
    config = DatmoConfig()
    stages = {name: {**getattr(config, name).model_dump(), **new} for name, new in settings.items()}
    return DatmoConfig.model_validate({**config.model_dump(), **stages})


def benchmark_detection(
    scenarios: Sequence[str],
    seeds: Sequence[int],
    frames: int | None = None,
    ablation: bool = False,
    workers: int = 1,
    tell: Callable[[int], None] | None = None,
) -> list[Result]:
    """Play every scenario with every seed, the tracker in the loop.

    Args:
        scenarios: names or files. seeds: of the episodes. frames: scans an episode, all if None.
        ablation: also without each idea. workers: processes; the result does not depend on them.
        tell: told how many episodes are done.

    Raises:
        ConfigError: no scenario or no seed. ScenarioError: an unknown scenario.
    """
    if not scenarios or not seeds:
        raise ConfigError(f"scenarios {list(scenarios)}, seeds {list(seeds)}: give at least one of each")
    configs = {"whole": DatmoConfig()}
    if ablation:
        configs |= {f"without {name}": changed(new) for name, new in ABLATIONS.items()}
    worlds = [load(scenario) for scenario in scenarios]
    jobs = [Job(world, seed, frames, c) for c in configs.values() for world in worlds for seed in seeds]
    played = run_all(detect, jobs, workers, tell)
    each = len(worlds) * len(seeds)
    return [
        Result(name, [row for part in played[i * each : (i + 1) * each] for row in part])
        for i, name in enumerate(configs)
    ]


def shown(results: Sequence[Result]) -> list[Rows]:
    """The tables of the whole, its goals, and the ablation where there is one."""
    whole = results[0]
    made = [*tables(whole.rows), goal_table(whole.goals)]
    return [*made, _ablation(results)] if len(results) > 1 else made


def _ablation(results: Sequence[Result]) -> Rows:
    heads = ("method", *(goal.name for goal in results[0].goals))
    lines = [(r.name, *("-" if g.value is None else f"{g.value:.3f}" for g in r.goals)) for r in results]
    return Rows("ablation", heads, tuple(lines), left=1)


def drawn(scenarios: Sequence[str], seed: int, frames: int | None = None) -> bytes:
    """PNG of one object of each sort in one episode of each scenario, and of what feedback joins again."""
    alone = changed(ABLATIONS["feedback of the tracker"])
    found: dict[str, Portrait] = {}
    for scenario in scenarios:
        found = portraits(Job(load(scenario), seed, frames, DatmoConfig()), alone) | found
    return plot(found)


def write(
    results: Sequence[Result], picture: bytes, settings: Mapping[str, Any], folder: Path, force: bool
) -> None:
    """Leave detection.json, detection.md and detection.png in `folder`.

    Raises:
        OutputError: `folder` exists and `force` is not set.
    """
    content = {
        "benchmark": "detection",
        "settings": dict(settings),
        "results": [
            {"name": r.name, "goals": [{**asdict(g), "met": g.met} for g in r.goals]} for r in results
        ],
        "sightings": [asdict(row) for row in results[0].rows],
        "hardware": hardware(),
        "versions": versions(),
    }
    with writing_folder(folder, force) as beside:
        (beside / "detection.json").write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        text = "".join(f"{markdown(table)}\n" for table in shown(results))
        (beside / "detection.md").write_text(text, encoding="utf-8")
        (beside / "detection.png").write_bytes(picture)
