"""datmo benchmark ground: the ground methods beside Patchwork++ and linefit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from datmo.errors import ConfigError
from eval.commands import options as o

if TYPE_CHECKING:
    from eval.benchmark.ground import Grid
    from eval.benchmark.ground_report import Report

CLASSES, QUICK_CLASSES = "A,B,C,D,E,F,G,H", "A,E"
GRADES, QUICK_GRADES = "0,5,10,15", "0,10"

Classes = Annotated[
    str | None, typer.Option("--classes", metavar="A,..,H", help="ISO classes, flat, or rms heights [m].")
]
Grades = Annotated[str | None, typer.Option("--grades", metavar="0,5,..", help="Steepest slopes [%].")]
Methods = Annotated[
    str | None, typer.Option("--methods", metavar="M,M", help="Ground methods; all by default.")
]
Rounds = Annotated[int, typer.Option("--rounds", help="Times are medians over so many scans.")]
Scans = Annotated[int, typer.Option("--scans", help="Scans of each scene, a second apart.")]
Real = Annotated[
    Path | None,
    typer.Option("--real", metavar="DIR", help="Folder of real sweeps; default $DATMO_REAL_DATA."),
]
Quick = Annotated[bool, typer.Option("--quick", help=f"Classes {QUICK_CLASSES}, slopes {QUICK_GRADES}.")]
Ablation = Annotated[bool, typer.Option("--ablation", help="One method, each idea switched off in turn.")]
Table51 = Annotated[bool, typer.Option("--table51", help="The thesis's Table 5.1 with the true error.")]


def ground(
    classes: Classes = None,
    grades: Grades = None,
    methods: Methods = None,
    seed: o.Seed = 0,
    scans: Scans = 1,
    rounds: Rounds = 5,
    real: Real = None,
    quick: Quick = False,
    ablation: Ablation = False,
    table51: Table51 = False,
    out: o.OutFolder = None,
    force: o.Force = False,
) -> None:
    """Ground methods beside Patchwork++ and linefit, over roughness and slope.

    Scenes come from the simulator (roughness x slope, with traffic, people, walls and poles; made
    once and kept in the cache), real sweeps from --real. All methods run in one process, in turn.

    With --out, leaves ground.json, ground.csv, ground.md and ground.png in DIR.

    \b
    Examples:
      datmo benchmark ground --quick
      datmo benchmark ground --classes D,E,0.3 --grades 10 --methods z --out runs/ground
      datmo benchmark ground --ablation --quick
      datmo benchmark ground --table51 --classes A,C,E --grades 0,10
    """
    from eval.output import refuse_existing

    if out is not None:
        refuse_existing(out, force)
    grid = asked_grid(classes, grades, seed, scans, quick)
    own = None if methods is None else names("methods", methods)
    leave(made(grid, own, rounds, real, ablation, table51), out, force)


def asked_grid(classes: str | None, grades: str | None, seed: int, scans: int, quick: bool) -> Grid:
    """The scenes that were asked for; what was not said is that of the whole or the quick grid."""
    from eval.benchmark.ground import Grid

    named = names("classes", classes if classes is not None else QUICK_CLASSES if quick else CLASSES)
    steep = numbers("grades", grades if grades is not None else QUICK_GRADES if quick else GRADES)
    return Grid(named, steep, seed, scans)


def made(
    grid: Grid, methods: list[str] | None, rounds: int, real: Path | None, ablation: bool, table51: bool
) -> Report:
    """The answer to the question that was asked, with a bar while scenes are made and played."""
    from datmo.ground import METHODS
    from eval import console
    from eval.benchmark.ground import ablate, anew, compare
    from eval.benchmark.ground_table51 import methods_there

    if ablation and table51:
        raise ConfigError("--ablation and --table51 are two questions; give one of them")
    if ablation and methods is not None and len(methods) != 1:
        raise ConfigError(f"--methods {','.join(methods)}: --ablation takes one method apart; give one")
    with console.progress("scenes", len(grid)) as tell:
        if ablation:
            return ablate(grid, methods[0] if methods else None, rounds, tell)
        if table51:
            return anew(grid, methods or methods_there(), rounds, tell)
        return compare(grid, methods or list(METHODS), rounds, real, tell)


def leave(report: Report, out: Path | None, force: bool) -> None:
    """Print what was found and, where asked, write it."""
    from eval import console
    from eval.benchmark.ground_report import write

    show(report)
    if out is not None:
        write(report, out, force)
        console.stdout().print(f"written: {out}", markup=False)


def show(report: Report) -> None:
    """Print the tables, and what follows from them."""
    from eval import console
    from eval.benchmark.table import rich_table

    screen = console.stdout()
    for table in report.tables:
        screen.print(rich_table(table))
        screen.print()
    for sentence in report.sentences:
        screen.print(sentence, markup=False)


def names(option: str, text: str) -> list[str]:
    """ "A,E" as names, each once.

    Raises:
        ConfigError: there is none.
    """
    found = list(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    if not found:
        raise ConfigError(f"--{option} {text!r} names nothing; give at least one, joined by commas")
    return found


def numbers(option: str, text: str) -> list[float]:
    """ "0,10" as numbers, each once.

    Raises:
        ConfigError: it is no such list, or empty.
    """
    try:
        return list(dict.fromkeys(float(part) for part in names(option, text)))
    except ValueError:
        raise ConfigError(f"--{option} {text!r} is no list of numbers; write e.g. 0,5,10") from None
