"""datmo run: play a scenario, score it, report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from eval.commands import options as o

if TYPE_CHECKING:
    from eval.report.recording import Recording


def run(
    scenario: o.Scenario,
    seed: o.Seed = 0,
    frames: o.Frames = None,
    ground: o.GroundMethod = None,
    out: o.OutFolder = None,
    set_: o.Settings = None,
    force: o.Force = False,
) -> None:
    """Play a scenario, score it, write a report.

    Traffic, terrain, sweep, detector and tracker, each stage held against the truth.

    Leaves config.yaml, metrics.json, metrics.csv, report.html and figures/ in DIR
    (runs/SCENARIO-seedN by default). Exit status 1: an expectation of the scenario is not met.

    \b
    Examples:
      datmo run rough-crossing
      datmo run rough-crossing --seed 7 --set terrain.grade=0.1 --out steep
      datmo run steep/config.yaml --seed 7 --frames 20
    """
    from eval import console
    from eval.run import choose_folder, play, write
    from scenarios.load import load

    what = load(scenario, o.settings(set_))
    folder = choose_folder(out, what, seed, force)
    with console.progress(what.name, min(frames or what.scans, what.scans)) as tell:
        recording = play(what, seed, frames, ground, console.on_step(tell))
    write(recording, folder, force)
    raise typer.Exit(tell_result(recording, folder))


def tell_result(recording: Recording, folder: Path) -> int:
    """Print the table, the verdict and where the report is; returns the exit status."""
    from eval import console
    from eval.verdict import judge

    verdicts = judge(recording.scenario.expect, recording.metrics, recording.whole)
    failed = [v.name for v in verdicts if v.failed]
    still = [v.name for v in verdicts if v.open]
    screen = console.stdout()
    screen.print(console.metric_table(recording.metrics, verdicts))
    if verdicts:
        said = f"not met: {', '.join(failed)}" if failed else f"all {len(verdicts) - len(still)} met"
        said += f"; open, as the run was cut short: {', '.join(still)}" if still else ""
        screen.print(f"\nexpectations: {said}")
    screen.print(f"report: {folder / 'report.html'}", markup=False)
    return 1 if failed else 0
