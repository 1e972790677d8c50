"""Ground labels: which returns are ground, and how much of the objects is swallowed by it (leak)."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from datmo.arrays import F64, I64, Array, Bool
from datmo.bins import BINS, SEGMENTS, bin_edges
from datmo.messages import PERSONS, VEHICLES, Frame, Truth, is_any
from eval.metrics.ratio import f1, mean, ratio

RADIUS = 50.0
BANDS = (0.0, 10.0, 20.0, 30.0, 50.0)
BAND_NAMES = ("0-10", "10-20", "20-30", "30-50")
FOOT = 0.1
EDGES = bin_edges()
STEPS = 20.0
IS_SOFT = is_any(np.arange(256, dtype=np.uint8), VEHICLES + PERSONS)
START_BIN = np.searchsorted(EDGES, np.arange(0, EDGES[-1], 1 / STEPS), side="right").clip(1) - 1


def grid_centres() -> F64:
    """Centres (21600, 2) [m, sensor] of the fixed grid of 2 degrees x 120 bins, segment by segment."""
    azimuth = -np.pi + (np.arange(SEGMENTS) + 0.5) * 2 * np.pi / SEGMENTS
    r = (EDGES[:-1] + EDGES[1:]) / 2
    xy = np.stack([np.outer(np.cos(azimuth), r), np.outer(np.sin(azimuth), r)], -1)
    return xy.reshape(-1, 2)


def cell_of(xy: Array) -> I64:
    """Cell (n,) of the fixed grid that each finite place (n, 2) [m, sensor] lies in, -1 outside it."""
    r = np.hypot(xy[:, 0], xy[:, 1])
    segment = np.floor((np.arctan2(xy[:, 1], xy[:, 0]) + np.pi) * (SEGMENTS / (2 * np.pi)))
    within = (r >= EDGES[0]) & (r < EDGES[-1])
    # A table finds the bin or the one before it; steps are finer than the narrowest bin.
    ring = START_BIN[(np.where(within, r, EDGES[0]) * STEPS).astype(np.int64)]
    ring = ring + (r >= EDGES[ring + 1])
    return np.where(within, (segment.astype(np.int64) % SEGMENTS) * BINS + ring, -1)


def band_of(r: Array) -> I64:
    """Range band (n,) of horizontal ranges (n,) [m], an index into `BAND_NAMES`."""
    return np.asarray(sum((r >= start).astype(np.int64) for start in BANDS[1:-1]), np.int64)


def label_counts(frame: Frame, truth: Truth) -> Counter[Any]:
    """Counts over the returns within 50 m of one scan.

    Keys: ("labels", band, truly ground, called ground); "leaked" and "leakable" returns of
    vehicles and persons; the same with "high_" for those more than 0.1 m above the true ground;
    ("object", id) and ("object leaked", id).
    """
    points = frame.scan.points
    r = np.hypot(points[:, 0], points[:, 1])
    near = (r <= RADIUS) & np.isfinite(points[:, 2])
    code = band_of(r[near]) * 4 + truth.is_ground[near] * 2 + frame.ground.is_ground[near]
    table = np.bincount(code, minlength=4 * len(BAND_NAMES))
    counts: Counter[Any] = Counter()
    for i, count in enumerate(table.tolist()):
        counts["labels", i // 4, bool(i & 2), bool(i & 1)] = count

    rows = np.flatnonzero(near & IS_SOFT[truth.kind])
    called = frame.ground.is_ground[rows]
    high = points[rows, 2] - truth.height[rows] > FOOT
    counts["leakable"], counts["leaked"] = len(rows), int(called.sum())
    counts["high_leakable"], counts["high_leaked"] = int(high.sum()), int((called & high).sum())
    _count_objects(counts, truth, truth.actor[rows], called)
    return counts


def _count_objects(counts: Counter[Any], truth: Truth, actor: Array, called: Bool) -> None:
    known = actor >= 0
    total = np.bincount(actor[known], minlength=len(truth.boxes))
    leaked = np.bincount(actor[known & called], minlength=len(truth.boxes))
    for i in np.flatnonzero(total):
        counts["object", int(truth.boxes.id[i])] = int(total[i])
        counts["object leaked", int(truth.boxes.id[i])] = int(leaked[i])


def label_scores(counts: Counter[Any], bands: range = range(len(BAND_NAMES))) -> dict[str, float | None]:
    """precision, recall and f1 of "ground", those of the complement, and leak, from counts."""

    def total(true: bool, called: bool) -> int:
        return sum(counts["labels", band, true, called] for band in bands)

    hit, false = total(True, True), total(False, True)
    missed, other = total(True, False), total(False, False)
    return {
        "ground.precision": ratio(hit, hit + false),
        "ground.recall": ratio(hit, hit + missed),
        "ground.f1": f1(hit, false, missed) if hit + missed else None,
        "ground.leak": ratio(counts["leaked"], counts["leakable"]),
        "ground.obstacle_precision": ratio(other, other + missed),
        "ground.obstacle_recall": ratio(other, other + false),
    }


def label_detail(counts: Counter[Any]) -> dict[str, Any]:
    """What stands beside the labels' scores: by range band, leak per object and above the foot."""
    ids = [key[1] for key in counts if isinstance(key, tuple) and key[0] == "object"]
    shares = {i: counts["object leaked", i] / counts["object", i] for i in ids}
    by_band = {}
    for band, name in enumerate(BAND_NAMES):
        scores = label_scores(counts, range(band, band + 1))
        by_band[name] = {k.removeprefix("ground."): v for k, v in scores.items() if k != "ground.leak"}
    return {
        "by_range": by_band,
        "leak_per_object": mean(list(shares.values())),
        "leak_above_0.1m": ratio(counts["high_leaked"], counts["high_leakable"]),
        "leak_of_object": {str(i): share for i, share in sorted(shares.items())},
    }
