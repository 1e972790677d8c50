"""Sightings as figures: recall, errors, splits and merges, and the stage that lost what was lost."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from datmo.messages import VEHICLES, Kind, Visibility
from eval.benchmark.sightings import Sighting
from eval.benchmark.table import Rows, say
from eval.metrics.diagnosis import Stage
from eval.metrics.ratio import mean

BANDS = (0.0, 10.0, 20.0, 30.0, 40.0, 60.0, 80.0)  # [m]
PERSON_RANGE, VEHICLE_RANGE = 25.0, 40.0  # [m]
LOST = (Stage.GROUND, Stage.CLUSTERS, Stage.RULES, Stage.BOXES)
HEADS = (
    "objects",
    "recall [%]",
    "corner [m]",
    "yaw [deg]",
    "IoU",
    "split [%]",
    "merged [%]",
    *(f"lost in {stage.name.lower()} [%]" for stage in LOST),
)
Figures = tuple[float | None, ...]


def median(values: Iterable[float | None]) -> float | None:
    """Median of those that are there."""
    known = [value for value in values if value is not None]
    return float(np.median(known)) if known else None


def figures(rows: Sequence[Sighting]) -> Figures:
    """In the order of `HEADS`, as shares of one; errors are medians."""
    lost = (mean([row.stage == stage for row in rows]) for stage in LOST)
    return (
        float(len(rows)),
        mean([row.found for row in rows]),
        median(row.corner_error for row in rows),
        median(row.yaw_error for row in rows),
        median(row.iou for row in rows),
        mean([row.split for row in rows]),
        mean([row.merged for row in rows]),
        *lost,
    )


def tables(rows: Sequence[Sighting]) -> list[Rows]:
    """By class, by range and by visibility."""
    bands = [f"{a:g}-{b:g} m" for a, b in pairwise(BANDS)]
    kinds = [kind.name.lower() for kind in Kind]
    seen = [v.name.lower() for v in reversed(Visibility)]
    return [
        _grouped("class", rows, kinds, lambda row: kinds[row.kind]),
        _grouped("range", rows, bands, lambda row: bands[_band(row.distance)]),
        _grouped("visibility", rows, seen, lambda row: Visibility(row.visibility).name.lower()),
    ]


def _band(distance: float) -> int:
    return min(int(np.searchsorted(BANDS, distance, side="right")) - 1, len(BANDS) - 2)


def _grouped(
    title: str, rows: Sequence[Sighting], groups: Sequence[str], key: Callable[[Sighting], str]
) -> Rows:
    made = []
    for group in (*groups, "all"):
        part = [row for row in rows if group in (key(row), "all")]
        if part:
            made.append((group, *_cells(figures(part))))
    return Rows(title, (title, *HEADS), tuple(made), left=1)


def _cells(found: Figures) -> Iterable[str]:
    number, recall, corner, yaw, iou, *shares = found
    yaw = None if yaw is None else float(np.rad2deg(yaw))
    return (
        say(number, digits=0),
        say(recall, 100, 1),
        say(corner, digits=3),
        say(yaw, digits=1),
        say(iou, digits=2),
        *(say(share, 100, 1) for share in shares),
    )


@dataclass(frozen=True)
class Goal:
    """A figure that the project asks of itself: what was reached, and its limit."""

    name: str
    value: float | None
    least: float | None = None
    most: float | None = None

    @property
    def met(self) -> bool | None:
        """None where there is nothing to measure."""
        if self.value is None:
            return None
        low = -np.inf if self.least is None else self.least
        return bool(low <= self.value <= (np.inf if self.most is None else self.most))


def goals(rows: Sequence[Sighting]) -> list[Goal]:
    """What objects with ten returns or more must reach."""
    vehicles = [row for row in rows if Kind(row.kind) in VEHICLES]
    near = [row for row in vehicles if row.distance <= VEHICLE_RANGE]
    persons = [row for row in rows if row.kind == Kind.PEDESTRIAN and row.distance <= PERSON_RANGE]
    shown = {v: [row for row in rows if row.visibility == v] for v in Visibility}
    visible = [row for row in vehicles if row.visibility == Visibility.VISIBLE]
    turn = median(row.yaw_error for row in visible)

    def recall(part: Sequence[Sighting]) -> float | None:
        return mean([row.found for row in part])

    return [
        Goal("recall of vehicles within 40 m", recall(near), least=0.97),
        Goal("recall of persons within 25 m", recall(persons), least=0.95),
        Goal("recall, partial", recall(shown[Visibility.PARTIAL]), least=0.90),
        Goal("recall, heavy", recall(shown[Visibility.HEAVY]), least=0.60),
        Goal("visible corner, median error [m]", median(row.corner_error for row in rows), most=0.10),
        Goal("yaw of visible vehicles, median error [deg]", turn and float(np.rad2deg(turn)), most=2.0),
        Goal("IoU of visible cars, median", median(r.iou for r in visible if r.kind == Kind.CAR), least=0.75),
        Goal("split", mean([row.split for row in rows]), most=0.03),
        Goal("merged", mean([row.merged for row in rows]), most=0.03),
    ]


def goal_table(found: Sequence[Goal]) -> Rows:
    """Figure, limit and whether it is met."""
    made = []
    for goal in found:
        limit = f"at least {goal.least:g}" if goal.least is not None else f"at most {goal.most:g}"
        met = "-" if goal.met is None else "yes" if goal.met else "no"
        made.append((goal.name, say(goal.value), limit, met))
    return Rows("goals", ("figure", "reached", "asked", "met"), tuple(made), left=1)
