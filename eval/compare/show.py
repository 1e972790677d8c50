"""The comparison as a table, a record and a figure."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from rich.table import Table

from eval.compare.judge import Line
from eval.compare.profile import BINS, Profile
from eval.facts import versions
from eval.output import writing_folder
from eval.report.style import SERIES, plain, png

MARK = {True: "yes", False: "NO", None: ""}


def say(value: float, unit: str) -> str:
    """A value as the table shows it."""
    if not np.isfinite(value):
        return "-"
    text = f"{value:,.0f}" if abs(value) >= 100 else f"{value:.4f}" if unit == "m" else f"{value:.3f}"
    return f"{text} {unit}".strip()


def table(lines: Sequence[Line]) -> Table:
    """A row a statistic: real, simulated, what is asked, whether it is met."""
    made = Table(box=None, header_style="bold", pad_edge=False)
    made.add_column("statistic")
    for name in ("real", "simulated", "asked", "met"):
        made.add_column(name, justify="right")
    for line in lines:
        row = say(line.real, line.unit), say(line.simulated, line.unit), line.limit, MARK[line.met]
        made.add_row(line.name, *row, style="bold red" if line.met is False else None)
    return made


def record(
    lines: Sequence[Line], real: Sequence[str], scenario: str, seed: int, sweeps: int
) -> dict[str, Any]:
    """Everything that the comparison depends on, and its lines; what is missing is null."""
    rows = [
        {k: None if isinstance(v, float) and not np.isfinite(v) else v for k, v in asdict(line).items()}
        for line in lines
    ]
    return {
        "real": list(real),
        "scenario": scenario,
        "seed": seed,
        "sweeps": sweeps,
        "lines": rows,
        "versions": versions(),
    }


def picture(real: Profile, simulated: Profile) -> bytes:
    """PNG: share of returns over range, and of missing firings over rings."""
    made = Figure(figsize=(8.2, 3.0), layout="constrained")
    left, right = made.subplots(1, 2)
    for axes in (left, right):
        plain(axes)
    x = np.arange(len(BINS) - 1)
    for i, (name, one) in enumerate((("real", real), ("simulated", simulated))):
        left.bar(x + 0.4 * i - 0.2, one.ranges, 0.38, color=SERIES[i], label=name)
        right.plot(np.arange(len(one.missing)), one.missing, color=SERIES[i], linewidth=1.4, label=name)
    left.set_xticks(x, [f"{a:.0f}-{b:.0f}" for a, b in pairwise(BINS)], fontsize=7)
    left.set_xlabel("range [m]")
    left.set_ylabel("share of returns")
    right.set_xlabel("ring, from the top")
    right.set_ylabel("share of firings without a return")
    left.legend(frameon=False, fontsize=8)
    return png(made)


def write(content: dict[str, Any], figure: bytes, folder: Path, force: bool) -> None:
    """Leave compare.json and compare.png in `folder`.

    Raises:
        OutputError: `folder` exists and `force` is not set.
    """
    with writing_folder(folder, force) as beside:
        (beside / "compare.json").write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
        (beside / "compare.png").write_bytes(figure)
