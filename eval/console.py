"""The terminal: tables of metrics and a progress bar with the live score."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from datmo.arrays import I64
from datmo.messages import Boxes
from eval.report.sweep_table import SHOWN, Sweep
from eval.score import Metric
from eval.verdict import Verdict, say_value

WIDE = 120
ROWS = 25  # boxes shown
LIVE = (("ground.f1", "ground f1"), ("detection.recall", "recall"), ("tracking.gospa", "gospa [m]"))


def stdout() -> Console:
    """Where results go; a pipe or a file has room for a whole table."""
    console = Console(highlight=False, soft_wrap=True)
    if not console.is_terminal:
        console.width = max(console.width, WIDE)
    return console


def stderr() -> Console:
    """Where progress and errors go."""
    return Console(stderr=True, highlight=False, soft_wrap=True)


def live_score(metrics: Mapping[str, float | None]) -> str:
    """The step's score in a few words."""
    return "  ".join(f"{label} {say_value(metrics.get(name)):>6}" for name, label in LIVE)


@contextmanager
def progress(what: str, total: int) -> Iterator[Callable[[int, str], None]]:
    """A bar on stderr; call it with how many are done and what to say beside it."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TextColumn("{task.fields[note]}"),
        TimeRemainingColumn(compact=True),
    )
    screen = stderr()
    with Progress(*columns, console=screen, transient=True, disable=not screen.is_terminal) as bar:
        task = bar.add_task(what, total=total, note="")
        yield lambda done, note: bar.update(task, completed=done, note=note)


def on_step(tell: Callable[[int, str], None]) -> Callable[[int, int, dict[str, Any]], None]:
    """What `play` calls after each frame, so that the bar shows the live score."""

    def say(done: int, _total: int, info: dict[str, Any]) -> None:
        tell(done, live_score(info["metrics"]))

    return say


def metric_table(metrics: Sequence[Metric], verdicts: Sequence[Verdict]) -> Table:
    """The metrics with their units, and what is expected of them."""
    held = {v.name: v for v in verdicts}
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("metric")
    table.add_column("value", justify="right")
    table.add_column("unit")
    table.add_column("expected")
    group = ""
    for metric in metrics:
        prefix = metric.name.partition(".")[0]
        if group and prefix != group:
            table.add_row()
        group = prefix
        unit = "" if metric.unit == "1" else metric.unit
        table.add_row(metric.name, say_value(metric.value), unit, _expected(held.get(metric.name)))
    return table


def _expected(verdict: Verdict | None) -> str:
    if verdict is None:
        return ""
    colour = "green" if verdict.met else "bold red" if verdict.failed else "yellow"
    return f"{verdict.bound}  [{colour}]{verdict.word}[/]"


def count_table(rows: Sequence[tuple[str, int, int]]) -> Table:
    """Points by label: name, code, count and share."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name, justify in (("points", "left"), ("label", "right"), ("count", "right"), ("share", "right")):
        table.add_column(name, justify=justify)  # type: ignore[arg-type]
    total = max(sum(count for _, _, count in rows), 1)
    for name, code, count in rows:
        table.add_row(name, str(code), f"{count:,}", f"{100 * count / total:.1f} %")
    return table


def box_table(boxes: Boxes, points: I64) -> Table:
    """The nearest `ROWS` boxes, from near to far."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("x [m]", "y [m]", "length [m]", "width [m]", "height [m]", "yaw [deg]", "points", "score"):
        table.add_column(name, justify="right")
    near = np.argsort(np.hypot(boxes.center[:, 0], boxes.center[:, 1]), kind="stable")
    for i in near[:ROWS]:
        numbers = [*boxes.center[i, :2], *boxes.size[i], np.degrees(boxes.yaw[i])]
        table.add_row(*(f"{v:.1f}" for v in numbers), str(points[i]), f"{boxes.score[i]:.2f}")
    return table


def sweep_table(made: Sweep) -> Table:
    """The scores of a sweep, means over the seeds."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for key in made.keys:
        table.add_column(key.rpartition(".")[2])
    for metric in SHOWN:
        table.add_column(metric.replace(".", "\n").replace("_", "\n"), justify="right", no_wrap=True)
    for row, point in enumerate(made.points):
        table.add_row(*point, *(say_value(made.mean(row, metric)) for metric in SHOWN))
    return table
