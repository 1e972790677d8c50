"""What `datmo benchmark lines` leaves: a table, JSON and a figure."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from rich.table import Table

from datmo.ground.lines import COUNT, END, INTERCEPT, SLOPE, START, extract_lines
from eval.benchmark.lines import MOST_OFF, MOST_TURN, OVERLAP, RULES, SHORTEST, Result, profiles
from eval.benchmark.profiles import KINDS
from eval.facts import hardware, versions
from eval.output import writing_folder
from eval.report.style import DPI, FAINT, INK, SERIES, plain, png

HEADS = ("segment, us", "frame, ms", "ratio")
CORRECT = ("true pos., %", "false pos., %", "missed, %", "sigma r, cm", "alpha, deg")


def table(results: Sequence[Result]) -> Table:
    """A row for each extractor, with the thesis's columns; the ratio is to the incremental's time."""
    made = Table(box=None, header_style="bold", pad_edge=False)
    made.add_column("extractor", no_wrap=True)
    for name in HEADS + CORRECT:
        made.add_column(name, justify="right")
    for result in results:
        t = result.tallies["all"]
        shares = [f"{100 * x:.1f}" for x in (t.true_positives, t.false_positives, t.misses)]
        sigmas = [f"{100 * t.sigma_r:.2f}", f"{np.degrees(t.sigma_alpha):.2f}"]
        times = [f"{result.segment_us:.1f}", f"{result.frame_ms:.2f}", f"{result.ratio:.2f}"]
        made.add_row(result.name, *times, *shares, *sigmas)
    return made


def record(results: Sequence[Result], asked: dict[str, int]) -> dict[str, Any]:
    """Everything that the figures depend on; a figure that nothing was measured for is null."""
    return {
        "benchmark": "lines",
        **asked,
        "rules": asdict(RULES),
        "fewest_points": SHORTEST,
        "match": {"overlap": OVERLAP, "turn_rad": float(MOST_TURN), "off_m": MOST_OFF},
        "extractors": [_plain(asdict(result)) for result in results],
        "hardware": hardware(),
        "versions": versions(),
    }


def _plain(value: Any) -> Any:
    """NaN as null, which JSON can say."""
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    return None if isinstance(value, float) and not np.isfinite(value) else value


def picture(results: Sequence[Result], first: int) -> bytes:
    """PNG: correctness over time, correctness by kind of profile, and one profile with its lines."""
    made = Figure(figsize=(9.6, 6.4), dpi=DPI, layout="constrained", facecolor="white")
    FigureCanvasAgg(made)
    grid = made.add_gridspec(2, 2)
    _trade(made.add_subplot(grid[0, 0]), results)
    _kinds(made.add_subplot(grid[0, 1]), results)
    _example(made.add_subplot(grid[1, :]), results, first)
    return png(made)


def _trade(axes: Axes, results: Sequence[Result]) -> None:
    """True positives (filled) and false positives (open) of all profiles over the time of a segment."""
    plain(axes)
    for result, color in zip(results, SERIES, strict=False):
        t, x = result.tallies["all"], result.segment_us
        axes.plot([x, x], [100 * t.false_positives, 100 * t.true_positives], color=color, lw=0.8, alpha=0.4)
        axes.plot(x, 100 * t.true_positives, "o", color=color, ms=6, label=result.name)
        axes.plot(x, 100 * t.false_positives, "o", color=color, ms=6, mfc="white")
    axes.set_xscale("log")
    axes.set_ylim(0, 103)
    axes.set_xlabel("time a segment [us]")
    axes.set_ylabel("true (filled), false (open) [%]")
    axes.legend(fontsize=7, frameon=False, labelcolor=INK, loc="center")


def _kinds(axes: Axes, results: Sequence[Result]) -> None:
    """Harmonic mean of what is found and what is right, by kind of profile."""
    plain(axes)
    width = 0.8 / len(results)
    for j, (result, color) in enumerate(zip(results, SERIES, strict=False)):
        tallies = [result.tallies[kind] for kind in KINDS]
        f1 = [200 * t.matched / (t.true + t.found) for t in tallies]
        axes.bar(np.arange(len(KINDS)) + (j + 0.5) * width - 0.4, f1, 0.9 * width, color=color)
    axes.set_xticks(range(len(KINDS)), KINDS)
    axes.set_ylim(0, 103)
    axes.set_ylabel("F1 of lines [%]")


def _example(axes: Axes, results: Sequence[Result], first: int) -> None:
    """The first profile with obstacles; under it the lines of each extractor, shifted down."""
    plain(axes)
    profile = next(p for p in profiles(1, 1, first) if p.kind == "obstacles")
    axes.plot(profile.r, profile.z, ".", color=FAINT, ms=3)
    for start, end, slope, intercept in profile.lines:
        axes.plot([start, end], [slope * start + intercept, slope * end + intercept], color=INK, lw=1)
    step = 0.3 * float(np.ptp(profile.z))
    for j, (result, color) in enumerate(zip(results, SERIES, strict=False)):
        for line in extract_lines(profile.r, profile.z, RULES, result.name):  # type: ignore[arg-type]
            if line[COUNT] >= SHORTEST:
                x = line[[START, END]]
                shifted = line[SLOPE] * x + line[INTERCEPT] - (j + 1) * step
                axes.plot(x, shifted, "|-", color=color, lw=1.4, ms=5)
        axes.annotate(
            result.name, (81, shifted[-1]), fontsize=7, color=color, va="center", annotation_clip=False
        )
    axes.set_xlim(0, 92)
    axes.set_xlabel("r [m]")
    axes.set_ylabel("z [m], each extractor lower")


def write(results: Sequence[Result], asked: dict[str, int], folder: Path, force: bool) -> None:
    """Leave lines.json and lines.png in `folder`; `asked` holds the arguments of `benchmark_lines`.

    Raises:
        OutputError: `folder` exists and `force` is not set.
    """
    with writing_folder(folder, force) as beside:
        text = json.dumps(record(results, asked), indent=2, allow_nan=False) + "\n"
        (beside / "lines.json").write_text(text, encoding="utf-8")
        (beside / "lines.png").write_bytes(picture(results, asked["first"]))
