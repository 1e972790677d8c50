"""datmo generate: labelled clouds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eval.commands import options as o


def generate(
    scenarios: Annotated[list[str], typer.Argument(metavar="SCENARIO...", help="Names or YAML files.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Where the clouds go.")],
    format_: Annotated[str, typer.Option("--format", help="semantickitti.")] = "semantickitti",
    frames: Annotated[int, typer.Option("--frames", min=1, help="Scans of each scenario.")] = 100,
    seed: o.Seed = 0,
    set_: o.Settings = None,
    workers: o.Workers = 1,
    force: o.Force = False,
) -> None:
    """Write labelled clouds.

    Every point has its class and instance, every scan its pose.

    One episode is one sequence under DIR/sequences; more frames than an episode has go on with
    the next seed in the next sequence. Workers play sequences side by side.

    \b
    Examples:
      datmo generate rough-crossing --format semantickitti --frames 50 --out clouds
      datmo generate rough-crossing empty-road --frames 300 --seed 7 --workers 2 --out clouds
    """
    from eval import console
    from eval import generate as generating
    from eval.output import refuse_existing
    from scenarios.load import load

    generating.check_format(format_)
    refuse_existing(out, force)
    worlds = [load(name, o.settings(set_)) for name in scenarios]
    total = len(generating.plan(worlds, frames, seed, format_, out))
    with console.progress("sequences", total) as tell:
        counts = generating.generate(
            worlds, frames, seed, format_, out, workers, force, lambda done: tell(done, "")
        )
    screen = console.stdout()
    screen.print(f"{sum(counts)} scans in {len(counts)} sequences: {out / 'sequences'}", markup=False)
    if sum(counts) < frames * len(worlds):
        screen.print("some episodes ended early (the ego crashed or arrived)")
