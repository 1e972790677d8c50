"""datmo benchmark: this project beside a named rival, in one process."""

from __future__ import annotations

from typing import Annotated

import typer

from datmo.errors import ConfigError
from eval.commands import options as o
from eval.commands.benchmark_boxes import boxes
from eval.commands.benchmark_detection import detection
from eval.commands.benchmark_ground import ground
from eval.commands.benchmark_lines import lines
from eval.commands.benchmark_recovery import recovery
from eval.commands.benchmark_tracker import tracker

benchmark = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Time this project beside a rival, interleaved in one process.",
)

Actors = Annotated[str, typer.Option("--actors", metavar="N,N", help="Numbers of moving actors.")]
Cells = Annotated[int, typer.Option("--cells", help="Terrain cells along each side.")]
Rounds = Annotated[int, typer.Option("--rounds", help="Sweeps of each number of actors.")]


@benchmark.callback()
def group() -> None:
    """Time this project beside a rival, interleaved in one process."""


benchmark.command("boxes")(boxes)
benchmark.command("detection")(detection)
benchmark.command("ground")(ground)
benchmark.command("lines")(lines)
benchmark.command("tracker")(tracker)
benchmark.command("recovery")(recovery)


@benchmark.command("cast")
def cast(
    actors: Actors = "0,10,40,160",
    cells: Cells = 800,
    rounds: Rounds = 15,
    out: o.OutFolder = None,
    force: o.Force = False,
) -> None:
    """A full sweep with returns and truth over a bare Embree cast of its rays.

    Both see the same terrain of 2 x CELLS x CELLS triangles and the same rays; the sweep also meets
    the moving actors, measures, and tells the truth of every ray. Medians over the rounds.

    With --out, leaves cast.json and cast.png in DIR.

    \b
    Examples:
      datmo benchmark cast
      datmo benchmark cast --actors 40 --rounds 30 --out runs/cast
    """
    from eval import console
    from eval.benchmark.cast import benchmark_cast
    from eval.benchmark.cast_report import table, write
    from eval.output import refuse_existing

    if out is not None:
        refuse_existing(out, force)
    with console.progress("rounds", rounds) as tell:
        points = benchmark_cast(numbers(actors), cells, rounds, lambda done: tell(done, ""))
    screen = console.stdout()
    screen.print(table(points))
    if out is not None:
        write(points, cells, rounds, out, force)
        screen.print(f"written: {out}", markup=False)


def numbers(text: str) -> list[int]:
    """ "0,10,40" as integers.

    Raises:
        ConfigError: it is no such list.
    """
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise ConfigError(f"--actors {text!r} is no list of integers; write e.g. 0,10,40") from None
