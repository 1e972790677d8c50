"""Tables of the recovery benchmark, beside what the project asked of itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from eval.benchmark.recovery import BINS, GROUPS, Recovery
from eval.benchmark.table import Rows, say
from eval.metrics.recovery import COAST_TIMES, Event
from eval.metrics.recovery_scores import bootstrap_share, coast_errors

ASKED_RATE: Mapping[str, Sequence[float]] = {
    "straight": (0.97, 0.96, 0.88, 0.65),
    "turning": (0.95, 0.85, 0.70, 0.45),
    "stop-and-go": (0.93, 0.85, 0.70, 0.40),
    "with confusers": (0.90, 0.80, 0.65, 0.35),
}
ASKED_WRONG = (0.03, 0.07, 0.15)  # of all events, by the first three of `BINS`
ASKED_ERROR = (0.5, 1.0, 1.6)  # [m] after `COAST_TIMES`, straight
ELLIPSE = 5.991  # chi-square of two dimensions, 95 %


def rates(result: Recovery, outcome: str = "recovered") -> Rows:
    """Share of events with an outcome, its 95 % interval and their number, by group and seconds hidden."""
    rows = []
    for group in GROUPS:
        row = [group]
        for i, seconds in enumerate(BINS):
            row.append(_share(result.owned(group, seconds), outcome))
            row.append(say(_asked(group, outcome, i), 1, 2))
        rows.append(tuple(row))
    heads = [part for seconds in BINS for part in (f"{seconds} s", "asked")]
    return Rows(f"{result.name}: {outcome}", (f"{result.name}: {outcome}", *heads), tuple(rows), left=1)


def errors(results: Sequence[Recovery]) -> Rows:
    """How far the owners of straight events are off while hidden, and what stands beside."""
    rows = []
    for result in results:
        straight = [e for e, _ in result.owned("straight")]
        found = [coast_errors(straight, after)["error"] for after in COAST_TIMES]
        hidden = 2 * np.array([v for e, _ in result.owned("all") for v in e.nees])
        rows.append(
            (
                result.name,
                *(say(v, 1, 2) for v in found),
                say(float(np.mean(hidden <= ELLIPSE)) if len(hidden) else None, 100, 1),
                say(float(np.median(result.nees)) if result.nees else None, 1, 2),
                say(float(np.mean(result.nees)) if result.nees else None, 1, 2),
                say(float(np.mean(result.nis)) if result.nis else None, 1, 2),
                str(sum(e.owner is None for e, _ in result.events)),
                str(result.censored),
            )
        )
    heads = (
        "tracker", *(f"error after {t:g} s [m]" for t in COAST_TIMES), "in the ellipse while hidden [%]",
        "NEES, median", "NEES, mean", "NIS", "without owner", "censored",
    )  # fmt: skip
    return Rows("errors", heads, tuple(rows), left=1)


def compared(results: Sequence[Recovery]) -> Rows:
    """Recovered and wrong of all trackers over all events, by seconds hidden [%]."""
    rows = []
    for result in results:
        row = [result.name]
        for seconds in BINS:
            events = [e for e, _ in result.owned("all", seconds)]
            shares = [
                100 * np.mean([e.outcome == o for e in events]) for o in ("recovered", "wrong") if events
            ]
            row.append(" / ".join(f"{share:.0f}" for share in shares) or "-")
        rows.append((*row, str(len(result.owned("all")))))
    heads = ("recovered / wrong [%]", *(f"{seconds} s" for seconds in BINS), "events")
    return Rows("compared", heads, tuple(rows), left=1)


def _share(events: Sequence[tuple[Event, int]], outcome: str) -> str:
    hits = [e.outcome == outcome for e, _ in events]
    interval = bootstrap_share(hits, [seed for _, seed in events])
    if interval is None:
        return "-"
    return f"{np.mean(hits):.2f} ({interval[0]:.2f}-{interval[1]:.2f}; {len(hits)})"


def _asked(group: str, outcome: str, column: int) -> float | None:
    if outcome == "recovered":
        return ASKED_RATE[group][column] if group in ASKED_RATE else None
    if outcome == "wrong" and group == "all" and column < len(ASKED_WRONG):
        return ASKED_WRONG[column]
    return None
