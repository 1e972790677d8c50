"""What `datmo benchmark recovery` shows and leaves: tables, JSON, curves."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from eval.benchmark.recovery import RIVALS, Recovery
from eval.benchmark.recovery_plot import recovery_curves
from eval.benchmark.recovery_table import compared, errors, rates
from eval.benchmark.table import Rows, markdown
from eval.facts import hardware, versions
from eval.output import writing_folder


def shown(results: Sequence[Recovery]) -> list[Rows]:
    """The tables of ours, and all trackers side by side."""
    return [rates(results[0]), rates(results[0], "wrong"), errors(results), compared(results)]


def write(results: Sequence[Recovery], seeds: Sequence[int], folder: Path, force: bool) -> None:
    """Leave recovery.json, recovery.md and recovery.png in `folder`.

    Raises:
        OutputError: `folder` exists and `force` is not set.
    """
    content = {
        "benchmark": "recovery",
        "seeds": list(seeds),
        "trackers": {
            r.name: {
                "events": [{"seed": seed, "duration": e.duration, **asdict(e)} for e, seed in r.events],
                "censored": r.censored,
                "ghosts": r.ghosts,
            }
            for r in results
        },
        "hardware": hardware(),
        "versions": versions(),
    }
    drawn = [r for r in results if r.name == results[0].name or r.name in RIVALS]
    with writing_folder(folder, force) as beside:
        (beside / "recovery.json").write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        text = "".join(f"{markdown(table)}\n" for table in shown(results))
        (beside / "recovery.md").write_text(text, encoding="utf-8")
        (beside / "recovery.png").write_bytes(recovery_curves(drawn))
