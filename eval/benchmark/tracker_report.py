"""What `datmo benchmark tracker` leaves of real sequences: tables and JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from datmo.tracks import TrackerConfig
from eval.benchmark.kitti_tracks import Drive
from eval.benchmark.table import Rows, markdown
from eval.benchmark.tracker_ablation import ablate
from eval.benchmark.tracker_real import LEAST_OVERLAP, RealScores, score_real
from eval.benchmark.tracker_rivals import rivals
from eval.facts import hardware, versions
from eval.output import writing_folder

SHARES = ("hota", "deta", "assa", "mota", "idf1", "motp")
COUNTS = ("switches", "fragmentations", "false", "missed")


def score(
    played: Sequence[Drive], ablation: bool
) -> tuple[dict[str, dict[str, RealScores]], dict[str, RealScores]]:
    """Figures of all trackers on some sequences, and of ours without each of its ideas if asked for."""
    return score_real(rivals(), played), ablate(TrackerConfig(), played) if ablation else {}


def shown(scores: Mapping[str, Mapping[str, RealScores]], ablation: Mapping[str, RealScores]) -> list[Rows]:
    """The trackers side by side, and the ablation where there is one."""
    made = [table("real sequences", {name: each["all"] for name, each in scores.items()})]
    return [*made, table("ablation", ablation)] if ablation else made


def table(title: str, scores: Mapping[str, RealScores]) -> Rows:
    """A row for each tracker or sequence; shares in percent, the mean time of a scan in ms."""
    rows = []
    for name, got in scores.items():
        shares = [f"{100 * getattr(got, s):.1f}" for s in SHARES]
        counts = [str(getattr(got, c)) for c in COUNTS]
        rows.append((name, *shares, *counts, f"{got.milliseconds:.1f}"))
    return Rows(title, (title, *SHARES, *COUNTS, "ms"), tuple(rows), left=1)


def record(
    scores: Mapping[str, Mapping[str, RealScores]], ablation: Mapping[str, RealScores]
) -> dict[str, Any]:
    """Every figure, by tracker and sequence, and what they depend on."""
    return {
        "benchmark": "tracker",
        "least_overlap": LEAST_OVERLAP,
        "trackers": {n: {d: _plain(s) for d, s in each.items()} for n, each in scores.items()},
        "ablation": {name: _plain(s) for name, s in ablation.items()},
        "hardware": hardware(),
        "versions": versions(),
    }


def _plain(scores: RealScores) -> dict[str, Any]:
    """NaN as null, which JSON can say."""
    return {k: None if isinstance(v, float) and np.isnan(v) else v for k, v in asdict(scores).items()}


def write(
    scores: Mapping[str, Mapping[str, RealScores]],
    ablation: Mapping[str, RealScores],
    folder: Path,
    force: bool,
) -> None:
    """Leave tracker.json and tracker.md in `folder`.

    Raises:
        OutputError: `folder` exists and `force` is not set.
    """
    with writing_folder(folder, force) as beside:
        text = json.dumps(record(scores, ablation), indent=1, allow_nan=False) + "\n"
        (beside / "tracker.json").write_text(text, encoding="utf-8")
        pages = "".join(f"{t.title}\n\n{markdown(t)}\n" for t in shown(scores, ablation))
        (beside / "tracker.md").write_text(pages, encoding="utf-8")
