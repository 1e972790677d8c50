"""datmo test: play scenarios and hold them to their expectations."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from datmo.errors import ScenarioError
from eval.commands import options as o

if TYPE_CHECKING:
    from scenarios.spec import Scenario

SUFFIX = ".scenario.yaml"


def check(
    paths: Annotated[
        list[str], typer.Argument(metavar="PATH...", help="*.scenario.yaml files, folders of them, or names.")
    ],
    seed: o.Seed = 0,
    frames: o.Frames = None,
    ground: o.GroundMethod = None,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Where reports of failures go.")] = Path(
        "runs"
    ),
) -> None:
    """Hold scenarios to their expectations.

    Each passes or fails by its expect: block; a failure leaves its report.

    Exit status 1: at least one failed. The same files are collected by pytest.

    \b
    Examples:
      datmo test tests/
      datmo test hidden-behind-truck.scenario.yaml --seed 3
      datmo test rough-crossing empty-road
    """
    from rich.markup import escape

    from eval import console
    from eval.output import unused
    from eval.run import play, replay_line, write
    from eval.verdict import judge, say_value

    found = collect(paths)
    screen, failures = console.stdout(), 0
    for source, scenario in found:
        start = perf_counter()
        with console.progress(scenario.name, min(frames or scenario.scans, scenario.scans)) as tell:
            recording = play(scenario, seed, frames, ground, console.on_step(tell))
        failed = [v for v in judge(scenario.expect, recording.metrics) if not v.met]
        word = "[bold red]FAIL[/]" if failed else "[green]pass[/]"
        screen.print(f"{word}  {escape(source)}  {perf_counter() - start:.1f} s")
        if failed:
            failures += 1
            folder = unused(out / f"{scenario.name}-seed{seed}")
            write(recording, folder)
            for v in failed:
                screen.print(f"      {v.name} is {say_value(v.value)}, expected {v.bound}", markup=False)
            screen.print(f"      report: {folder / 'report.html'}", markup=False)
            screen.print(f"      replay: {replay_line(recording, folder / 'config.yaml')}", markup=False)
    screen.print(f"{len(found) - failures} passed, {failures} failed")
    raise typer.Exit(1 if failures else 0)


def collect(paths: list[str]) -> list[tuple[str, Scenario]]:
    """Scenarios by the names and files given, folders searched; each must expect something.

    Raises:
        ScenarioError: a folder holds none, a file is wrong, or a scenario expects nothing.
    """
    from scenarios.load import load

    sources: list[str] = []
    for path in paths:
        if Path(path).is_dir():
            files = sorted(str(p) for p in Path(path).rglob(f"*{SUFFIX}"))
            if not files:
                raise ScenarioError(f"{path} holds no *{SUFFIX} file; name a folder that does, or a file")
            sources += files
        else:
            sources.append(path)
    found = [(source, load(source)) for source in sources]
    for source, scenario in found:
        if not scenario.expect:
            raise ScenarioError(f"{source} expects nothing, so it cannot fail; add an expect: block")
    return found
