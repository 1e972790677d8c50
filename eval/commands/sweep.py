"""datmo sweep: one scenario over a grid of its values."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eval.commands import options as o

Over = Annotated[
    list[str], typer.Option("--over", metavar="KEY=V1,V2", help="Values to go through; repeatable.")
]
Seeds = Annotated[str, typer.Option("--seeds", help="One (3), a list (0,4,7) or a range (0..4).")]


def sweep(
    scenario: o.Scenario,
    over: Over,
    seeds: Seeds = "0",
    frames: o.Frames = None,
    ground: o.GroundMethod = None,
    set_: o.Settings = None,
    workers: o.Workers = 1,
    out: o.OutFolder = None,
    force: o.Force = False,
) -> None:
    """Play a scenario over a grid of its values.

    Every combination gives a row of one table and a point of one figure.

    Leaves scores.csv (every metric but the times, each seed), table.md (means over seeds),
    figure.png and config.yaml in DIR (runs/sweep-SCENARIO by default).

    \b
    Examples:
      datmo sweep rough-crossing --over terrain.roughness=A,C,E,G --over terrain.grade=0,0.06,0.12
      datmo sweep rough-crossing --over sensor.noise.drop_out=0,0.1,0.3 --seeds 0..4 --workers 2
    """
    from eval import console
    from eval import sweep as sweeping
    from eval.output import refuse_existing, unused
    from scenarios.load import load

    grid, chosen, fixed = sweeping.parse_over(over), sweeping.parse_seeds(seeds), o.settings(set_)
    base = load(scenario, fixed)
    folder = out or unused(Path("runs") / f"sweep-{base.name}")
    refuse_existing(folder, force)
    jobs = sweeping.plan(scenario, grid, chosen, frames, ground, fixed)
    with console.progress(f"sweep {base.name}", len(jobs)) as tell:
        made = sweeping.sweep(jobs, grid, chosen, workers, lambda done: tell(done, ""))
    sweeping.write(made, base, folder, force)
    screen = console.stdout()
    screen.print(console.sweep_table(made))
    screen.print(f"table: {folder / 'table.md'}\nfigure: {folder / 'figure.png'}", markup=False)
