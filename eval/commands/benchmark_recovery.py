"""datmo benchmark recovery: what becomes of tracks while their objects are hidden, on simulated scenes."""

from __future__ import annotations

from typing import Annotated

import typer

from eval.commands import options as o

Seeds = Annotated[int, typer.Option("--seeds", min=1, help="Seeds; each plays 24 scenes of 10 to 14 s.")]
First = Annotated[int, typer.Option("--seed", min=0, metavar="N", help="The first of them.")]
Enough = Annotated[
    int | None,
    typer.Option("--enough", min=1, metavar="EVENTS", help="Skip scenes whose class has so many events."),
]
Ablation = Annotated[bool, typer.Option("--ablation", help="Also without each idea of the tracker, in turn.")]


def recovery(
    seeds: Seeds = 1,
    first: First = 1000,
    enough: Enough = None,
    ablation: Ablation = False,
    workers: o.Workers = 1,
    out: o.OutFolder = None,
    force: o.Force = False,
) -> None:
    """Recovery of what was hidden behind walls, by seconds hidden and by motion, the detector in the loop.

    Ours, its ablation, the thesis's tracker and a plain Kalman filter, the latter on the boxes that the
    loop made. A seed gives about 150 events in three to four minutes of two cores; with --enough 150 some
    80 seeds give every class so many in an hour and a half. With --out, leaves recovery.json, .md and .png
    (the curves) in DIR.

    \b
    Examples:
      datmo benchmark recovery --workers 2
      datmo benchmark recovery --seeds 80 --enough 150 --workers 2 --ablation --out runs/recovery
    """
    from eval import console
    from eval.benchmark.recovery import ABLATIONS, RIVALS, benchmark_recovery
    from eval.benchmark.recovery_report import shown, write
    from eval.benchmark.table import rich_table
    from eval.output import refuse_existing

    if out is not None:
        refuse_existing(out, force)
    beside = {**RIVALS, **(ABLATIONS if ablation else {})}
    numbers = list(range(first, first + seeds))
    with console.progress("scenes", 24 * seeds) as tell:
        results = benchmark_recovery(numbers, beside, workers, lambda n: tell(n, ""), enough)
    screen = console.stdout()
    for table in shown(results):
        screen.print(rich_table(table))
        screen.print()
    if out is not None:
        write(results, numbers, out, force)
        screen.print(f"written: {out}", markup=False)
