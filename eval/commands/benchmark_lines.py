"""datmo benchmark lines: the six line extractors on profiles whose lines are known."""

from __future__ import annotations

from typing import Annotated

import typer

from eval.commands import options as o

Seeds = Annotated[int, typer.Option("--seeds", help="Seeds of the profiles.")]
First = Annotated[int, typer.Option("--seed", metavar="N", help="The first of them.")]
Each = Annotated[int, typer.Option("--profiles", help="Profiles of each kind and seed.")]
Rounds = Annotated[int, typer.Option("--rounds", help="Timed frames of 180 profiles.")]


def lines(
    seeds: Seeds = 5,
    first: First = 0,
    each: Each = 36,
    rounds: Rounds = 5,
    out: o.OutFolder = None,
    force: o.Force = False,
) -> None:
    """Six line extractors on random profiles whose lines are known (Appendix D).

    Speed, lines found, false and missed, and the spread of the errors of r, the line's distance from
    the sensor, and of alpha, the angle of its normal. All six have the same profiles and rules and
    take turns in one process. Times are medians.

    With --out, leaves lines.json and lines.png in DIR.

    \b
    Examples:
      datmo benchmark lines
      datmo benchmark lines --seeds 20 --rounds 15 --out runs/lines
    """
    from eval import console
    from eval.benchmark.lines import benchmark_lines
    from eval.benchmark.lines_report import table, write
    from eval.output import refuse_existing

    if out is not None:
        refuse_existing(out, force)
    with console.progress("rounds", rounds) as tell:
        results = benchmark_lines(seeds, each, rounds, first, lambda done: tell(done, ""))
    screen = console.stdout()
    screen.print(table(results))
    if out is not None:
        asked = {"seeds": seeds, "first": first, "each": each, "rounds": rounds}
        write(results, asked, out, force)
        screen.print(f"written: {out}", markup=False)
