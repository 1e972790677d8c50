"""Ghosts: tracks that live on after their object left, and tracks in space that is seen to be empty."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from datmo.arrays import I64, Array, Bool
from datmo.geometry import inverse, transform
from datmo.messages import Frame, Status, Visibility
from eval.metrics.history import History
from eval.metrics.matching import finite
from eval.metrics.ratio import mean, spread

OWNED_FOR = 0.5
CORE = 0.5
BEHIND = 0.5
THINNING = 4
LEAST_RAYS = 2


@dataclass(frozen=True)
class Ghost:
    """How long the owner of an object lived on after that left for good [s]; `cut` by the run's end."""

    object: int
    owner: int
    seconds: float
    cut: bool


def ghosts(history: History) -> list[Ghost]:
    """One for each object that left for good (absent or out of range to the end) and had an owner.

    A track lives on while it is reported and not matched to another object.
    """
    found = []
    n = len(history.moments)
    for object_id in history.ids():
        life = history.life(object_id)
        left = int(np.flatnonzero(life.state >= Visibility.HIDDEN).max(initial=-1)) + 1
        owner = history.owner(life, left, OWNED_FOR) if 0 < left < n else None
        if owner is None:
            continue
        scans = 0
        for m in history.moments[left:]:
            if owner not in m.track_row or owner in m.partner.values():
                break
            scans += 1
        found.append(Ghost(object_id, owner, scans * history.period, left + scans == n))
    return found


def ghost_scores(found: list[Ghost]) -> dict[str, float | None]:
    """The named score."""
    return {"recovery.ghost_time": mean([g.seconds for g in found])}


def ghost_detail(found: list[Ghost], history: History) -> dict[str, Any]:
    """The spread of ghost times, and the seconds of coasting through empty space (all tracks)."""
    scans = sum(int(m.in_empty_space.sum()) for m in history.moments)
    return {
        "ghost_time": spread([g.seconds for g in found]),
        "cut_by_end": sum(g.cut for g in found),
        "empty_space_seconds": scans * history.period,
    }


def in_empty_space(frame: Frame, rows: I64) -> Bool:
    """Which tracks of `rows` (t,) coast (status > 5) where rays show that nothing stands.

    So it is when at least two of every fourth ray pass through the core of the box (half its
    extent), to return from more than 0.5 m behind it, and none returns from within the box.
    """
    empty = np.zeros(len(rows), bool)
    coasting = np.flatnonzero(frame.tracks.status[rows] > Status.TRACKING)
    if not len(coasting):
        return empty
    points: Array = frame.scan.points[::THINNING].astype(float)
    points = points[finite(points)]
    boxes = frame.tracks.boxes.select(rows[coasting])
    center = transform(inverse(frame.scan.T_world_sensor), boxes.center)
    half = boxes.size[:, :2].min(1) / 2
    for i, track in enumerate(coasting.tolist()):
        distance = float(np.hypot(center[i, 0], center[i, 1]))
        u = center[i, :2] / max(distance, 1e-6)
        along = points[:, 0] * u[0] + points[:, 1] * u[1]
        radius = float(np.hypot(*boxes.size[i, :2])) / 2
        far = np.flatnonzero(along > distance - radius)
        scale = distance / np.maximum(along[far], 1e-6)
        aside = np.abs(points[far, 0] * u[1] - points[far, 1] * u[0]) * scale
        up = np.abs(points[far, 2] * scale - center[i, 2])
        core = (aside <= CORE * half[i]) & (up <= CORE * boxes.size[i, 2] / 2)
        beyond = along[far] > distance + radius + BEHIND
        passed, stopped = np.count_nonzero(core & beyond), np.count_nonzero(core & ~beyond)
        empty[track] = passed >= LEAST_RAYS and not stopped
    return empty
