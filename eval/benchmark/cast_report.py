"""What `datmo benchmark cast` leaves: a table, JSON and the figure of the curve."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.table import Table

from eval.benchmark.cast import BLOCKS, EXTENT, FARTHEST, NEAREST, THREADS, Point
from eval.facts import hardware, versions
from eval.output import writing_folder
from eval.report.style import FAINT, SERIES, figure, png

TARGET = 2.2
"""The most that a sweep may cost, in bare casts, with `TARGET_ACTORS` actors."""
TARGET_ACTORS = 40


def table(points: Sequence[Point]) -> Table:
    """A row for each number of actors; the stages of the sweep beside it."""
    made = Table(box=None, header_style="bold", pad_edge=False)
    stages = list(points[0].stages)
    heads = ["actors", "rays caught", "bare, ms", "sweep, ms", "ratio", "quartiles", "of the fastest"]
    for name in heads + [f"{stage}, ms" for stage in stages]:
        made.add_column(name, justify="right")
    for p in points:
        ratios = [f"{p.ratio:.2f}", f"{p.low:.2f}-{p.high:.2f}", f"{p.best:.2f}"]
        times = [f"{p.bare_ms:.1f}", f"{p.sweep_ms:.1f}", *ratios]
        made.add_row(str(p.actors), str(p.caught), *times, *(f"{p.stages[s]:.1f}" for s in stages))
    return made


def record(points: Sequence[Point], cells: int, rounds: int) -> dict[str, Any]:
    """Everything that the figures depend on."""
    return {
        "benchmark": "cast",
        "rival": f"embreex EmbreeScene.run(origins, directions), {BLOCKS} blocks on {THREADS} threads",
        "triangles": 2 * cells * cells,
        "extent_m": EXTENT,
        "actors_from_to_m": [NEAREST, FARTHEST],
        "rounds": rounds,
        "points": [asdict(point) for point in points],
        "hardware": hardware(),
        "versions": versions(),
    }


def curve(points: Sequence[Point]) -> bytes:
    """PNG of the ratio over the number of actors, with its quartiles."""
    made, axes = figure(5.2, 3.2)
    x = [point.actors for point in points]
    low, high = [point.low for point in points], [point.high for point in points]
    axes.fill_between(x, low, high, color=SERIES[0], alpha=0.2, linewidth=0)
    axes.plot(x, [point.ratio for point in points], "o-", color=SERIES[0], markersize=4, linewidth=1.4)
    axes.axhline(1, color=FAINT, linewidth=0.8)
    axes.plot([TARGET_ACTORS], [TARGET], "v", color=SERIES[1], markersize=7)
    axes.annotate(
        f"at most {TARGET:g}", (TARGET_ACTORS, TARGET), (6, 4), textcoords="offset points", fontsize=8
    )
    axes.set_xlabel("moving actors in range")
    axes.set_ylabel("full sweep / bare Embree cast")
    axes.set_ylim(0, None)
    return png(made)


def write(points: Sequence[Point], cells: int, rounds: int, folder: Path, force: bool) -> None:
    """Leave cast.json and cast.png in `folder`.

    Raises:
        OutputError: `folder` exists and `force` is not set.
    """
    with writing_folder(folder, force) as beside:
        text = json.dumps(record(points, cells, rounds), indent=2) + "\n"
        (beside / "cast.json").write_text(text, encoding="utf-8")
        (beside / "cast.png").write_bytes(curve(points))
