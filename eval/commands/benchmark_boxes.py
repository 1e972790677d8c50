"""datmo benchmark boxes: what clusters and boxes of a sweep cost, beside a Python loop."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Annotated

import typer

from eval.commands import options as o

Names = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="[SCENARIO]...",
        help="Names or YAML files; rough-crossing, city-street and crowded-street unless a cloud is given.",
    ),
]
Files = Annotated[
    list[Path] | None,
    typer.Option("--cloud", metavar="FILE.bin", help="A sweep of float32 x, y, z, intensity; repeatable."),
]
Rounds = Annotated[int, typer.Option("--rounds", help="Turns of the rival and of ten runs of each stage.")]


def boxes(
    scenarios: Names = None,
    cloud: Files = None,
    seed: o.Seed = 0,
    rounds: Rounds = 10,
    out: o.OutFolder = None,
    force: o.Force = False,
) -> None:
    """Refine, cluster, fit boxes to and filter a full sweep, beside a Python loop of the rectangle search.

    The sweeps are the first of each scenario, and files; crowded-street is city-street with a hundred
    clusters. The rival searches the same clusters over all their points. All take turns in one process;
    times are the best of the rounds. With --out, leaves boxes.json and boxes.md in DIR.

    \b
    Examples:
      datmo benchmark boxes
      datmo benchmark boxes city-street --rounds 30 --out runs/boxes
      datmo benchmark boxes --cloud scan.bin
    """
    from eval import console
    from eval.benchmark.boxes import benchmark_boxes, sweeps_of
    from eval.benchmark.boxes_table import shown, write
    from eval.benchmark.table import rich_table
    from eval.output import refuse_existing

    if out is not None:
        refuse_existing(out, force)
    sweeps = sweeps_of(scenarios or [], cloud or [], seed)
    done = itertools.count(1)
    with console.progress("rounds", rounds * len(sweeps)) as tell:
        results = [benchmark_boxes(sweep, rounds, lambda: tell(next(done), "")) for sweep in sweeps]
    screen = console.stdout()
    for table in shown(results):
        screen.print(rich_table(table))
        screen.print()
    if out is not None:
        write(results, {"sweeps": [sweep.source for sweep in sweeps], "rounds": rounds}, out, force)
        screen.print(f"written: {out}", markup=False)
