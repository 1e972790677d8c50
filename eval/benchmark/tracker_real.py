"""Trackers on real sequences, scored by TrackEval on the 3-D overlap of their boxes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from datmo.arrays import F64, I64
from datmo.errors import ConfigError
from datmo.messages import Boxes, Kind
from eval.benchmark.kitti_tracks import Drive
from eval.benchmark.tracker_rivals import Rival
from eval.benchmark.tracking_overlap import iou_3d

LEAST_OVERLAP = 0.25
"""Least intersection over union of a match in MOTA, IDF1 and what goes with them; HOTA has its own."""


@dataclass(frozen=True)
class RealScores:
    """Figures of one tracker.

    Attributes:
        hota, deta, assa: means over the 19 thresholds of HOTA. mota, idf1: shares.
        motp: mean overlap of matches. switches, fragmentations, false, missed: numbers.
        milliseconds: mean time of a scan [ms].
    """

    hota: float
    deta: float
    assa: float
    mota: float
    idf1: float
    motp: float
    switches: int
    fragmentations: int
    false: int
    missed: int
    milliseconds: float = float("nan")


def score_real(contestants: Mapping[str, Rival], played: Sequence[Drive]) -> dict[str, dict[str, RealScores]]:
    """Figures of each contestant, by sequence, and over all of them under "all".

    Raises:
        ConfigError: TrackEval is not installed, or no sequence is given.
    """
    if not played:
        raise ConfigError("no sequences to play; give at least one")
    made = {}
    for name, rival in contestants.items():
        parts, seconds = {}, 0.0
        for drive in played:
            start = perf_counter()
            reported = play(rival, drive)
            spent = perf_counter() - start
            parts[drive.name] = evaluate(drive, reported), spent / len(drive)
            seconds += spent
        each = {d: _figures(part, spent) for d, (part, spent) in parts.items()}
        whole = combine([part for part, _ in parts.values()])
        made[name] = {"all": _figures(whole, seconds / sum(map(len, played))), **each}
    return made


def play(rival: Rival, drive: Drive) -> list[Boxes]:
    """What a tracker reports for each scan of a sequence, having seen no later one."""
    rival.reset()
    return [rival.step(b, float(t)) for b, t in zip(drive.detections, drive.stamps, strict=True)]


def evaluate(drive: Drive, reported: Sequence[Boxes]) -> dict[str, Any]:
    """TrackEval's results for one sequence, by metric."""
    data = as_trackeval(drive.truth, reported)
    return {name: metric.eval_sequence(data) for name, metric in _metrics().items()}


def combine(results: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """TrackEval's results for all sequences together, each detection and each identity counting alike."""
    return {
        name: metric.combine_sequences({str(i): result[name] for i, result in enumerate(results)})
        for name, metric in _metrics().items()
    }


def as_trackeval(truth: Sequence[Boxes], reported: Sequence[Boxes]) -> dict[str, Any]:
    """The in-memory form of a sequence; tracks matched to a distractor are taken out, and it with them."""
    frames = [_frame(t, r) for t, r in zip(truth, reported, strict=True)]
    objects = np.unique(np.concatenate([t for t, _, _ in frames]))
    tracks = np.unique(np.concatenate([r for _, r, _ in frames]))
    return {
        "gt_ids": [np.searchsorted(objects, t) for t, _, _ in frames],
        "tracker_ids": [np.searchsorted(tracks, r) for _, r, _ in frames],
        "similarity_scores": [s for _, _, s in frames],
        "num_gt_ids": len(objects),
        "num_tracker_ids": len(tracks),
        "num_gt_dets": sum(len(t) for t, _, _ in frames),
        "num_tracker_dets": sum(len(r) for _, r, _ in frames),
        "num_timesteps": len(frames),
    }


def _frame(truth: Boxes, reported: Boxes) -> tuple[I64, I64, F64]:
    """Ids of the cars (n,) and of the tracks to be judged (m,), and their overlap (n, m)."""
    overlap = iou_3d(truth, reported)
    car = truth.kind == Kind.CAR
    i, j = linear_sum_assignment(-np.where(overlap >= LEAST_OVERLAP, overlap, 0))
    excused = j[(overlap[i, j] >= LEAST_OVERLAP) & ~car[i]]
    judged = np.ones(len(reported), np.bool_)
    judged[excused] = False
    return truth.id[car], reported.id[judged], overlap[np.ix_(car, judged)]


def _metrics() -> dict[str, Any]:
    try:
        from trackeval.metrics import CLEAR, HOTA, Identity
    except ImportError:
        raise ConfigError("trackeval is not installed, and it scores tracks; pip install trackeval") from None
    config = {"THRESHOLD": LEAST_OVERLAP, "PRINT_CONFIG": False}
    return {"hota": HOTA(), "clear": CLEAR(config), "identity": Identity(config)}


def _figures(result: dict[str, Any], seconds: float) -> RealScores:
    hota, clear = result["hota"], result["clear"]
    return RealScores(
        hota=float(np.mean(hota["HOTA"])),
        deta=float(np.mean(hota["DetA"])),
        assa=float(np.mean(hota["AssA"])),
        mota=float(clear["MOTA"]),
        idf1=float(result["identity"]["IDF1"]),
        motp=float(clear["MOTP"]),
        switches=int(clear["IDSW"]),
        fragmentations=int(clear["Frag"]),
        false=int(clear["CLR_FP"]),
        missed=int(clear["CLR_FN"]),
        milliseconds=1e3 * seconds,
    )
