"""The command `datmo`."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import Annotated

import typer

from datmo.errors import DatmoError
from eval.commands.benchmark import benchmark
from eval.commands.catalog import catalog
from eval.commands.check import check
from eval.commands.compare import compare
from eval.commands.detect import detect
from eval.commands.digest import digest
from eval.commands.gallery import gallery
from eval.commands.generate import generate
from eval.commands.run import run
from eval.commands.segment import segment
from eval.commands.sweep import sweep
from eval.commands.view import view
from eval.facts import versions

DONE, NOT_MET, BAD_INPUT, STOPPED = 0, 1, 2, 130
USAGE_ERROR: type[Exception] = typer.BadParameter.__mro__[2]
"""Click's base of what a user mistyped; typer may carry its own copy of click."""

app = typer.Typer(
    name="datmo",
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
COMMANDS: dict[str, Callable[..., int | None]] = {
    "list": catalog,
    "run": run,
    "test": check,
    "sweep": sweep,
    "generate": generate,
    "digest": digest,
    "compare": compare,
    "segment": segment,
    "detect": detect,
    "view": view,
    "gallery": gallery,
}
for name, command in COMMANDS.items():
    app.command(name)(command)
app.add_typer(benchmark, name="benchmark")


def _say_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"datmo {versions()['datmo-gym']}")
        raise typer.Exit()


@app.callback()
def root(
    _version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_say_version, help="Show the version.")
    ] = False,
    _debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
) -> None:
    """A test-bed for lidar detection and tracking of moving objects.

    Exit status: 0 done, 1 an expectation is not met, 2 bad input.

    \b
    Examples:
      datmo list
      datmo run rough-crossing --seed 7
      datmo detect scan.bin --out boxes.json --picture boxes.png
      datmo run --help
    """


def call(arguments: list[str]) -> int:
    """Run the command line and return its exit status; errors become one line on stderr."""
    debug = "--debug" in arguments
    arguments = [a for a in arguments if a != "--debug"]
    try:
        status = app(arguments, prog_name="datmo", standalone_mode=False)
        if status == STOPPED:
            raise KeyboardInterrupt  # typer makes an exit status of it before we see it
        return status if isinstance(status, int) else DONE
    except (KeyboardInterrupt, typer.Abort):
        typer.echo("datmo: stopped", err=True)
        return STOPPED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except (USAGE_ERROR, DatmoError) as error:
        if debug:
            raise
        typer.echo(f"datmo: {say(error)}", err=True)
        return BAD_INPUT


def say(error: Exception) -> str:
    """An error in one line."""
    text = error.format_message() if isinstance(error, USAGE_ERROR) else str(error)  # type: ignore[attr-defined]
    return " ".join(text.split()) if isinstance(error, USAGE_ERROR) else "; ".join(text.splitlines())


def main() -> None:
    """Entry point of the command."""
    sys.exit(call(sys.argv[1:]))
