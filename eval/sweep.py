"""A sweep: one scenario over the product of some of its values, as one table and one figure."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from datmo.config import DatmoConfig
from datmo.errors import ConfigError
from eval.episode import episode, scans_to_play
from eval.output import writing_folder
from eval.pool import run_all
from eval.report.sweep_figure import sweep_figure
from eval.report.sweep_table import Sweep, to_csv, to_markdown
from eval.score import Metric
from eval.testbed import make_testbed
from scenarios.load import dump, load
from scenarios.spec import Scenario


@dataclass(frozen=True)
class Job:
    """One episode to score."""

    scenario: Scenario
    seed: int
    frames: int | None
    ground: str | None


def plan(
    scenario: str | Path,
    over: Mapping[str, Sequence[str]],
    seeds: Sequence[int] = (0,),
    frames: int | None = None,
    ground: str | None = None,
    settings: Mapping[str, str] | None = None,
) -> list[Job]:
    """An episode for every combination of values and every seed, all validated.

    Args:
        scenario: a name or a file. over: key -> values as `--set` takes them.
        seeds: of the episodes. frames: scans an episode. ground: method. settings: for all.

    Raises:
        ScenarioError: a key or a value does not fit the scenario. ConfigError: no such method.
    """
    if ground is not None:
        DatmoConfig().with_ground(ground)
    worlds = [
        load(scenario, {**(settings or {}), **dict(zip(over, point, strict=True))})
        for point in combinations(over)
    ]
    return [Job(world, seed, frames, ground) for world in worlds for seed in seeds]


def combinations(over: Mapping[str, Sequence[str]]) -> list[tuple[str, ...]]:
    """The product of the values, the last key running fastest."""
    return list(itertools.product(*over.values()))


def sweep(
    jobs: Sequence[Job],
    over: Mapping[str, Sequence[str]],
    seeds: Sequence[int],
    workers: int = 1,
    on_done: Callable[[int], None] | None = None,
) -> Sweep:
    """Play the jobs of `plan`.

    Args:
        jobs, over, seeds: as planned.
        workers: processes; the result does not depend on them. on_done: told how many are done.
    """
    results = run_all(score, jobs, workers, on_done)
    rows = [results[i : i + len(seeds)] for i in range(0, len(results), len(seeds))]
    return Sweep(tuple(over), combinations(over), list(seeds), rows)


def score(job: Job) -> dict[str, float | None]:
    """Play one episode; every metric but the times, which depend on who else is working."""
    env = make_testbed(job.scenario, ground=job.ground)
    try:
        for _ in episode(env, job.scenario, job.seed, scans_to_play(job.scenario, job.frames)):
            pass
        metrics: list[Metric] = list(env.result())
    finally:
        env.close()
    return {m.name: m.value for m in metrics if not m.name.startswith("speed.")}


def parse_over(pairs: Sequence[str]) -> dict[str, list[str]]:
    """KEY=V1,V2,... pairs as key -> values; commas inside brackets do not part values.

    Raises:
        ConfigError: no pair, a pair without "=", an empty value, or a key given twice.
    """
    found: dict[str, list[str]] = {}
    for pair in pairs:
        key, sign, text = pair.partition("=")
        key, values = key.strip(), [v.strip() for v in _split(text)]
        if not sign or not key or not all(values):
            raise ConfigError(f"--over {pair!r} is no KEY=V1,V2; write e.g. --over terrain.grade=0,0.06,0.12")
        if key in found:
            raise ConfigError(f"--over {key} is given twice; join its values: --over {key}=V1,V2")
        if len(set(values)) < len(values):
            raise ConfigError(f"--over {pair!r} names a value twice; name each once")
        found[key] = values
    if not found:
        raise ConfigError("nothing to sweep over; give at least one --over KEY=V1,V2")
    return found


def parse_seeds(text: str) -> list[int]:
    """ "3" is one seed, "0,4,7" are three, "0..4" are five.

    Raises:
        ConfigError: anything else.
    """
    try:
        first, dots, last = text.partition("..")
        seeds = list(range(int(first), int(last) + 1)) if dots else [int(s) for s in text.split(",")]
    except ValueError:
        seeds = []
    if not seeds or min(seeds) < 0 or len(set(seeds)) < len(seeds):
        raise ConfigError(f"--seeds {text!r} are no seeds; write one (3), a list (0,4,7) or a range (0..4)")
    return seeds


def _split(text: str) -> list[str]:
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "[{(") - (letter in ")}]")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


def write(made: Sweep, scenario: Scenario, folder: Path, force: bool = False) -> None:
    """Write scores.csv, table.md, figure.png and config.yaml into `folder`.

    Raises:
        OutputError: `folder` exists and `force` is not set.
    """
    with writing_folder(folder, force) as beside:
        (beside / "scores.csv").write_text(to_csv(made), encoding="utf-8")
        (beside / "table.md").write_text(to_markdown(made), encoding="utf-8")
        (beside / "figure.png").write_bytes(sweep_figure(made))
        (beside / "config.yaml").write_text(dump(scenario), encoding="utf-8")
