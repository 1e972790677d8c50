"""Shares, latencies and errors of recovery events, by duration, motion and confusers."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from datmo.arrays import Array
from eval.metrics.ratio import mean, ratio, spread
from eval.metrics.recovery import COAST_TIMES, Event

OUTCOMES = ("wrong", "recovered", "new id", "lost")
DURATIONS = ((1.0, "0.5-1"), (2.0, "1-2"), (3.0, "2-3"), (5.0, "3-5"), (np.inf, "> 5"))
RESAMPLES, CONFIDENCE = 1000, (2.5, 97.5)
EPS = 1e-6


def recovery_scores(events: Sequence[Event], objects: int) -> dict[str, float | None]:
    """The named scores, ghosts apart.

    All are over the events that have an owner; recovery.events is their number. recovery.latency
    counts any id. recovery.position_error is the owner's after 1 s hidden.

    Args:
        events: those of a run.
        objects: how many objects there were at all; without any, nothing could be counted.
    """
    owned = [e for e in events if e.owner is not None]
    return {
        "recovery.events": float(len(owned)) if objects else None,
        "recovery.rate": share(owned, "recovered"),
        "recovery.wrong_rate": share(owned, "wrong"),
        "recovery.latency": mean([e.latency for e in owned]),
        "recovery.position_error": coast_errors(owned, 1.0)["error"],
    }


def share(events: Sequence[Event], outcome: str) -> float | None:
    """Share of events with an outcome."""
    return ratio(sum(e.outcome == outcome for e in events), len(events))


def coast_errors(events: Sequence[Event], after: float) -> dict[str, float | None]:
    """Median errors [m] of the owners after some seconds hidden, and the share of them alive."""
    all_ = [e.coasts[after] for e in events if after in e.coasts]
    alive = [c for c in all_ if c is not None]
    errors = {n: _median([getattr(c, n) for c in alive]) for n in ("error", "along", "across")}
    return {**errors, "alive": ratio(len(alive), len(all_)), "owners": float(len(all_))}


def _median(values: list[float]) -> float | None:
    return float(np.median(values)) if values else None


def duration_class(event: Event) -> str:
    """The event's class of duration [s]; lower ends belong to it."""
    return next(name for end, name in DURATIONS if event.duration < end - EPS)


def bootstrap_share(hits: Sequence[bool], groups: Sequence[Hashable]) -> tuple[float, float] | None:
    """95 % interval of a share, resampling whole groups (seeds); None without events.

    With a single group there is nothing to resample but its events, which is done instead; the
    interval is then too narrow where events of one run resemble each other.
    """
    if not hits:
        return None
    names = list(dict.fromkeys(groups))
    index = {name: i for i, name in enumerate(names)}
    member = np.array([index[g] for g in groups]) if len(names) > 1 else np.arange(len(hits))
    total = np.bincount(member).astype(float)
    hit = np.bincount(member, weights=np.asarray(hits, float))
    draw = np.random.default_rng(0).integers(len(total), size=(RESAMPLES, len(total)))
    shares: Array = hit[draw].sum(1) / total[draw].sum(1)
    low, high = np.percentile(shares, CONFIDENCE)
    return float(low), float(high)


def summary(events: Sequence[Event], seeds: Sequence[Hashable]) -> dict[str, Any]:
    """Outcome shares of owned events with their intervals, and what stands beside them."""
    kept = [(e, s) for e, s in zip(events, seeds, strict=True) if e.owner is not None]
    owned, groups = [e for e, _ in kept], [s for _, s in kept]
    shares = {}
    for outcome in OUTCOMES:
        interval = bootstrap_share([e.outcome == outcome for e in owned], groups)
        shares[outcome] = {"share": share(owned, outcome), "interval": interval}
    return {
        "events": len(owned),
        "without_owner": len(events) - len(owned),
        "outcomes": shares,
        "rate_all": share(events, "recovered"),
        "stolen": ratio(sum(e.stolen for e in owned), len(owned)),
        "latency": spread([e.latency for e in owned]),
        "latency_all": spread([e.latency for e in events]),
        "owner_latency": spread([e.owner_latency for e in owned]),
        "hidden": {str(after): coast_errors(owned, after) for after in COAST_TIMES},
    }


def recovery_detail(
    events: Sequence[Event], censored: int, seeds: Sequence[Hashable] | None = None
) -> dict[str, Any]:
    """Everything about recovery, JSON-able; `events` of many runs may be given with their seeds."""
    seeds = [0] * len(events) if seeds is None else seeds
    splits: dict[str, Callable[[Event], str]] = {
        "by_duration": duration_class,
        "by_motion": lambda e: e.motion,
        "by_confusers": lambda e: str(e.confusers),
    }
    detail: dict[str, Any] = {**summary(events, seeds), "censored": censored}
    for name, key in splits.items():
        classes = sorted({key(e) for e in events})
        rows = {c: [i for i, e in enumerate(events) if key(e) == c] for c in classes}
        detail[name] = {c: summary([events[i] for i in r], [seeds[i] for i in r]) for c, r in rows.items()}
    detail["list"] = [_plain(e) for e in events]
    return detail


def _plain(event: Event) -> dict[str, Any]:
    plain = asdict(event)
    plain["coasts"] = {str(after): coast for after, coast in plain["coasts"].items()}
    return {**plain, "duration": event.duration}
