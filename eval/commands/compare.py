"""datmo compare: real sweeps beside simulated ones."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eval.commands import options as o

Reals = Annotated[list[Path], typer.Argument(metavar="REAL.bin...", help="Sweeps as KITTI stores them.")]
World = Annotated[str, typer.Option("--scenario", metavar="NAME", help="What is simulated.")]
Sweeps = Annotated[int, typer.Option("--sweeps", min=1, help="Simulated sweeps, spread over the episode.")]


def compare(
    real: Reals,
    scenario: World = "city-street",
    seed: o.Seed = 0,
    sweeps: Sweeps = 10,
    set_: o.Settings = None,
    out: o.OutFolder = None,
    force: o.Force = False,
) -> int:
    """How near simulated sweeps come to real ones of an HDL-64E.

    Prints each statistic of the real and of the simulated sweeps, means over both, what is asked of
    the simulated, and whether it is met. Classes of the real sweeps are known where a .label file
    lies beside the .bin; else those of ten labelled sweeps of KITTI stand in.

    With --out, leaves compare.json and compare.png in DIR. Exit status 1 where something is not met.

    \b
    Examples:
      datmo compare velodyne/*.bin
      datmo compare scan.bin --scenario rough-crossing --seed 3 --out runs/compare
    """
    from eval import console
    from eval.compare import show
    from eval.compare.sweeps import side_by_side
    from eval.output import refuse_existing
    from scenarios.load import load

    if out is not None:
        refuse_existing(out, force)
    world = load(scenario, o.settings(set_))
    with console.progress("scans", world.scans) as tell:
        measured, made, lines = side_by_side(real, world, seed, sweeps, tell)
    console.stdout().print(show.table(lines))
    if out is not None:
        content = show.record(lines, [path.name for path in real], world.name, seed, sweeps)
        show.write(content, show.picture(measured, made), out, force)
        console.stdout().print(f"written: {out}", markup=False)
    return int(any(line.met is False for line in lines))
