"""datmo test: play scenarios and hold them to their expectations."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from datmo.errors import ScenarioError
from eval.commands import options as o

if TYPE_CHECKING:
    from eval.report.recording import Recording
    from scenarios.spec import Scenario

SUFFIX = ".scenario.yaml"
Paths = Annotated[
    list[str], typer.Argument(metavar="PATH...", help="*.scenario.yaml files, folders of them, or names.")
]
Out = Annotated[Path, typer.Option("--out", metavar="DIR", help="Where reports of failures go.")]


def check(
    paths: Paths,
    seed: o.Seed = 0,
    frames: o.Frames = None,
    ground: o.GroundMethod = None,
    out: Out = Path("runs"),
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
    from eval.run import play

    found = collect(paths)
    screen, failures = console.stdout(), 0
    for source, scenario in found:
        start = perf_counter()
        with console.progress(scenario.name, min(frames or scenario.scans, scenario.scans)) as tell:
            recording = play(scenario, seed, frames, ground, console.on_step(tell))
        lines = complaint(recording, out)
        failures += bool(lines)
        word = "[bold red]FAIL[/]" if lines else "[green]pass[/]"
        screen.print(f"{word}  {escape(source)}  {perf_counter() - start:.1f} s")
        for line in lines:
            screen.print(f"      {line}", markup=False)
    screen.print(f"{len(found) - failures} passed, {failures} failed")
    raise typer.Exit(1 if failures else 0)


def complaint(recording: Recording, out: Path) -> list[str]:
    """What is not met and how to see it again; writes the report of a failure. Empty for a pass."""
    from eval.output import unused
    from eval.run import replay_line, write
    from eval.verdict import judge, say_value

    failed = [v for v in judge(recording.scenario.expect, recording.metrics) if not v.met]
    if not failed:
        return []
    folder = unused(out / f"{recording.scenario.name}-seed{recording.seed}")
    write(recording, folder)
    lines = [f"{v.name} is {say_value(v.value)}, expected {v.bound}" for v in failed]
    lines.append(f"report: {folder / 'report.html'}")
    lines.append(f"replay: {replay_line(recording, folder / 'config.yaml')}")
    return lines


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
