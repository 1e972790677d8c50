"""What `datmo benchmark ground` leaves: ground.json, ground.csv, ground.md and ground.png."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from eval.benchmark.ground_figures import NAMES
from eval.benchmark.ground_grid import Row
from eval.benchmark.ground_plot import plot
from eval.benchmark.table import Rows, markdown
from eval.facts import hardware, versions
from eval.output import writing_folder


@dataclass(frozen=True)
class Report:
    """All that a call of the command found.

    Attributes:
        settings: what was asked for. rows: of the simulated grid. tables: to print. sentences: what
            follows from them, in words. extra: what else goes into ground.json.
    """

    settings: Mapping[str, Any]
    rows: Sequence[Row]
    tables: Sequence[Rows]
    sentences: Sequence[str]
    extra: Mapping[str, Any] = field(default_factory=dict)


def record(report: Report) -> str:
    """The text of ground.json."""
    content = {
        "benchmark": "ground",
        "settings": dict(report.settings),
        "sentences": list(report.sentences),
        "rows": [asdict(row) for row in report.rows],
        **report.extra,
        "hardware": hardware(),
        "versions": versions(),
    }
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def comma_separated(rows: Sequence[Row]) -> str:
    """The text of ground.csv: a line for each scene and method; empty where there is no figure."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("scene", "class", "grade", "method", *NAMES))
    for row in rows:
        values = (row.figures[name] for name in NAMES)
        cells = ("" if v is None else f"{v:.6g}" for v in values)
        writer.writerow((row.scene, row.roughness, f"{row.grade:g}", row.method, *cells))
    return text.getvalue()


def page(report: Report) -> str:
    """The text of ground.md."""
    parts = [f"{markdown(table)}\n" for table in report.tables]
    return "".join(parts) + "".join(f"- {sentence}\n" for sentence in report.sentences)


def write(report: Report, folder: Path, force: bool) -> None:
    """Leave the files in `folder`; the figure only where there is a grid to show.

    Raises:
        OutputError: `folder` exists and `force` is not set.
    """
    with writing_folder(folder, force) as beside:
        (beside / "ground.json").write_text(record(report), encoding="utf-8")
        (beside / "ground.csv").write_text(comma_separated(report.rows), encoding="utf-8")
        (beside / "ground.md").write_text(page(report), encoding="utf-8")
        if report.rows:
            (beside / "ground.png").write_bytes(plot(report.rows))
