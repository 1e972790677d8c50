"""What recovery and ghosts need to remember of each scan, and the life of one object through them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from datmo.arrays import F64, I64, U8, Bool
from datmo.messages import Boxes, Frame, Status, Truth
from eval.metrics.detection import Matched
from eval.metrics.matching import distances, gates, reaches
from eval.metrics.pairing import Paired

ABSENT = -1
NONE = -1
FED_WITHIN = 4.0


@dataclass(frozen=True)
class Moment:
    """One scan.

    Attributes:
        stamp: [s]. objects: the k true boxes. visibility: (k,).
        row: object id -> its row. gate, reach: (k,) [m].
        track_row: track id -> row among the t reported tracks.
        place: (t, 2) [m, world]. cov: (t, 2, 2) [m²].
        partner: object id -> id of the track matched to it.
        fed: (t,) id of the object whose detection updated each track, -1 none known.
        in_empty_space: (t,) coasting where rays show that nothing stands.
    """

    stamp: float
    objects: Boxes
    visibility: U8
    row: dict[int, int]
    gate: F64
    reach: F64
    track_row: dict[int, int]
    place: F64
    cov: F64
    partner: dict[int, int]
    fed: I64
    in_empty_space: Bool


def moment(frame: Frame, truth: Truth, paired: Paired, matched: Matched, in_empty_space: Bool) -> Moment:
    """Remember one scan."""
    rows = np.flatnonzero(frame.tracks.confirmed())
    tracks = frame.tracks.boxes.select(rows)
    return Moment(
        stamp=truth.stamp,
        objects=truth.boxes,
        visibility=truth.visibility,
        row={int(a): i for i, a in enumerate(truth.boxes.id)},
        gate=gates(truth.boxes),
        reach=reaches(truth.boxes.kind),
        track_row={int(a): i for i, a in enumerate(tracks.id)},
        place=tracks.center[:, :2],
        cov=frame.tracks.cov[rows][:, :2, :2],
        partner=paired.partner,
        fed=fed_by(frame, truth, matched, rows),
        in_empty_space=in_empty_space,
    )


def fed_by(frame: Frame, truth: Truth, matched: Matched, rows: I64) -> I64:
    """Id (t,) of the object whose measurement updated each track of `rows` (t,), -1 none known.

    The messages do not carry the association. A track counts as updated when its status is 5 (a
    miss moves it on), and by the detection nearest to it, if that lies within 4 m.
    """
    fed = np.full(len(rows), NONE, np.int64)
    updated = np.flatnonzero(frame.tracks.status[rows] == Status.TRACKING)
    if not len(frame.boxes) or not len(updated):
        return fed
    distance = distances(frame.tracks.boxes.center[rows[updated]], frame.boxes.center)
    nearest = distance.argmin(1)
    actor = matched.actor[nearest]
    known = (actor >= 0) & (distance.min(1) <= FED_WITHIN)
    fed[updated[known]] = truth.boxes.id[actor[known]]
    return fed


@dataclass(frozen=True)
class Life:
    """One object over the n scans of a run; NaN, -1 where it is absent.

    Attributes:
        id: of the object. state: (n,) `Visibility`, -1 absent.
        xy: (n, 2) [m, world]. yaw: (n,) [rad]. speed: (n,) [m/s].
        partner: (n,) id of the track matched to it, -1 none.
    """

    id: int
    state: I64
    xy: F64
    yaw: F64
    speed: F64
    partner: I64


class History:
    """The moments of a run, in order."""

    def __init__(self, moments: list[Moment]) -> None:
        self.moments = moments
        self.stamps = np.array([m.stamp for m in moments], float)

    @cached_property
    def period(self) -> float:
        """Median time between scans [s]; 0 for fewer than two."""
        return float(np.median(np.diff(self.stamps))) if len(self.stamps) > 1 else 0.0

    def ids(self) -> list[int]:
        """Every object that was ever there."""
        return sorted({i for m in self.moments for i in m.row})

    def life(self, object_id: int) -> Life:
        """One object through all scans."""
        n = len(self.moments)
        state, partner = np.full(n, ABSENT, np.int64), np.full(n, NONE, np.int64)
        xy, yaw, speed = np.full((n, 2), np.nan), np.full(n, np.nan), np.full(n, np.nan)
        for k, m in enumerate(self.moments):
            row = m.row.get(object_id)
            if row is None:
                continue
            state[k], partner[k] = m.visibility[row], m.partner.get(object_id, NONE)
            xy[k], yaw[k] = m.objects.center[row, :2], m.objects.yaw[row]
            speed[k] = np.hypot(*m.objects.velocity[row])
        return Life(object_id, state, xy, yaw, speed, partner)

    def track(self, track_id: int | None, scan: int) -> int | None:
        """Row of a reported track in a scan, None when it is not there."""
        return None if track_id is None else self.moments[scan].track_row.get(track_id)

    def owner(self, life: Life, scan: int, window: float, eps: float = 1e-6) -> int | None:
        """The track matched to the object for most of the `window` [s] before a scan."""
        start = self.stamps[scan] - window - eps
        before = life.partner[(self.stamps >= start) & (np.arange(len(self.stamps)) < scan)]
        ids, counts = np.unique(before[before != NONE], return_counts=True)
        if not len(ids) or 2 * counts.max() <= len(before):
            return None
        return int(ids[counts.argmax()])
