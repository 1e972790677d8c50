"""What came of a sweep, and its tables."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

import numpy as np

from eval.verdict import say_value
from scenarios.expect import UNITS

SHOWN = (
    "ground.f1",
    "ground.leak",
    "ground.height_rmse",
    "detection.recall",
    "tracking.hota",
    "tracking.gospa",
    "tracking.id_switches",
    "recovery.rate",
)
"""The scores of the printed table and the figure; the CSV holds every one but the times."""


@dataclass(frozen=True)
class Sweep:
    """What was swept and what came of it.

    Attributes:
        keys: of the scenario. points: the values of each combination, in the order of the product.
        seeds: played for each combination.
        scores: for each combination, for each seed, metric -> value (None: nothing to measure).
    """

    keys: tuple[str, ...]
    points: list[tuple[str, ...]]
    seeds: list[int]
    scores: list[list[dict[str, float | None]]]

    def mean(self, row: int, metric: str) -> float | None:
        """Mean over the seeds that measured something."""
        values = [s[metric] for s in self.scores[row]]
        known = [v for v in values if v is not None]
        return float(np.mean(known)) if known else None


def to_csv(made: Sweep) -> str:
    """One row a combination and seed, one column a metric; empty where there was nothing to measure."""
    names = [name for name in UNITS if not name.startswith("speed.")]
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow([*made.keys, "seed", *names])
    for point, scores in zip(made.points, made.scores, strict=True):
        for seed, values in zip(made.seeds, scores, strict=True):
            numbers = [values.get(name) for name in names]
            rows.writerow([*point, seed, *("" if v is None else repr(float(v)) for v in numbers)])
    return text.getvalue()


def to_markdown(made: Sweep) -> str:
    """The table of `SHOWN`, means over the seeds."""
    head = [*made.keys, *(f"{m} [{UNITS[m]}]" if UNITS[m] not in ("1", "count") else m for m in SHOWN)]
    lines = [head, ["---"] * len(made.keys) + ["---:"] * len(SHOWN)]
    for row, point in enumerate(made.points):
        lines.append([*point, *(say_value(made.mean(row, m)) for m in SHOWN)])
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"
