"""What clusters and boxes cost, as tables and files."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from eval.benchmark.boxes import FIT, RIVAL, STAGES, Result
from eval.benchmark.table import Rows, markdown, say
from eval.facts import hardware, versions
from eval.output import writing_folder

MOST_MS = 12.0
"""The most that the stages may take together, for a sweep with 100 clusters on two cores [ms]."""
LEAST_RATIO = 40.0
"""The least that the rival must take, in times of the box fit and the filter."""


def shown(results: Sequence[Result]) -> list[Rows]:
    """The cost of each sweep, the best of the rounds, and how it compares."""
    costs, beside = [], []
    for r in results:
        stages, rival = tuple(say(r.best(stage), digits=2) for stage in STAGES), r.best(RIVAL)
        counts = str(r.points), str(r.clusters), str(r.boxes)
        costs.append((r.source, *counts, *stages, say(r.total, digits=2), _met(r.total <= MOST_MS)))
        ratios = say(ratio(r), digits=0), _met(ratio(r) >= LEAST_RATIO), say(rival / r.total, digits=0)
        beside.append((r.source, str(r.clustered), stages[-1], say(rival, digits=0), *ratios))
    cost_heads = ("sweep", "points", "clusters", "boxes", *STAGES, "sum", f"at most {MOST_MS:g}")
    heads = ("sweep", "points in clusters", FIT, RIVAL, "ratio", f"at least {LEAST_RATIO:g}", "ratio to sum")
    return [
        Rows("cost, best of the rounds [ms]", cost_heads, tuple(costs), left=1),
        Rows("beside the rival, best of the rounds [ms]", heads, tuple(beside), left=1),
    ]


def ratio(result: Result) -> float:
    """The rival's best time over that of the box fit and the filter [1]."""
    return result.best(RIVAL) / result.best(FIT)


def _met(met: bool) -> str:
    return "yes" if met else "no"


def write(results: Sequence[Result], settings: Mapping[str, Any], folder: Path, force: bool) -> None:
    """Leave boxes.json and boxes.md in `folder`.

    Raises:
        OutputError: `folder` exists and `force` is not set.
    """
    machine, releases = hardware(), versions()
    content = {
        "benchmark": "boxes",
        "settings": dict(settings),
        "rival": f"{RIVAL}: over clusters and angles, closeness by numpy",
        "asked": {"most_ms": MOST_MS, "least_ratio": LEAST_RATIO},
        "results": [asdict(result) for result in results],
        "hardware": machine,
        "versions": releases,
    }
    facts = "".join(f"- {name}: {value}\n" for name, value in (machine | releases).items())
    with writing_folder(folder, force) as beside:
        (beside / "boxes.json").write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        text = "".join(f"{table.title}\n\n{markdown(table)}\n" for table in shown(results))
        (beside / "boxes.md").write_text(text + facts, encoding="utf-8")
