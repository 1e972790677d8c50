"""Recovery: what becomes of a track while its object is hidden, and after."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from datmo.arrays import F64, I64, Bool
from datmo.messages import Visibility
from eval.metrics.history import NONE, History, Life

LEAST_HIDDEN, BEFORE, AFTER = 0.5, 0.5, 1.0
WRONG_FOR, STOLEN_SCANS = 0.3, 3
LATENCY_LIMIT = 3.0
COAST_TIMES = (1.0, 2.0, 3.0)
MOVING, TURN = 0.5, np.deg2rad(15.0)
EPS = 1e-6

Outcome = Literal["wrong", "recovered", "new id", "lost", "no owner"]
Motion = Literal["straight", "turning", "stop-and-go", "standing"]


@dataclass(frozen=True)
class Interval:
    """A hidden interval: scans `hide` (first hidden) to `reappear` (first not hidden, n = never)."""

    hide: int
    reappear: int


@dataclass(frozen=True)
class Coast:
    """The owner after some time hidden: distance to its object, along and across its heading [m]."""

    error: float
    along: float
    across: float


@dataclass(frozen=True)
class Event:
    """One object that hid and came out again.

    Attributes:
        object: its id. hidden_at, reappeared_at: [s].
        motion: of the object while hidden. confusers: other objects that came within d0 of it.
        owner: id of its track, None when none was matched for most of the last 0.5 s.
        stolen: the owner was fed by another object's measurements for 3 scans or more.
        latency, owner_latency: seconds to the first match, of any track and of the owner, at most 3.
        coasts: seconds hidden -> `Coast`, None for an owner that is dead by then.
        nees: of the owner's position in each hidden scan, divided by 2.
    """

    object: int
    hidden_at: float
    reappeared_at: float
    motion: Motion
    confusers: int
    owner: int | None
    outcome: Outcome
    stolen: bool
    latency: float
    owner_latency: float
    coasts: dict[float, Coast | None] = field(default_factory=dict)
    nees: list[float] = field(default_factory=list)

    @property
    def duration(self) -> float:
        """Seconds hidden."""
        return self.reappeared_at - self.hidden_at


def hidden_intervals(life: Life, stamps: F64) -> list[Interval]:
    """Intervals of at least 0.5 s, those parted by less than 0.5 s merged first.

    An interval lasts from the first hidden scan to the first that is not; one that the run cuts
    off, to the last scan.
    """
    edge = np.diff(np.concatenate([[0], life.state == Visibility.HIDDEN, [0]]).astype(int))
    merged: list[Interval] = []
    begins, ends = np.flatnonzero(edge == 1).tolist(), np.flatnonzero(edge == -1).tolist()
    for hide, reappear in zip(begins, ends, strict=True):
        start = hide
        if merged and stamps[hide] - stamps[merged[-1].reappear] < LEAST_HIDDEN - EPS:
            start = merged.pop().hide
        merged.append(Interval(start, reappear))
    last = len(stamps) - 1
    return [i for i in merged if stamps[min(i.reappear, last)] - stamps[i.hide] >= LEAST_HIDDEN - EPS]


def is_censored(interval: Interval, life: Life, stamps: F64) -> bool:
    """Whether the interval, 0.5 s before it and 1.0 s after are not all known and clear.

    Clear: not hidden before and after, in range (solo >= 5) throughout.
    """
    hide, reappear = interval.hide, interval.reappear
    if reappear >= len(stamps) or stamps[-1] < stamps[reappear] + AFTER - EPS:
        return True
    if stamps[0] > stamps[hide] - BEFORE + EPS:
        return True
    around = (stamps >= stamps[hide] - BEFORE - EPS) & (stamps <= stamps[reappear] + AFTER + EPS)
    state = life.state[around]
    clear = around.copy()
    clear[hide:reappear] = False
    return bool((state < Visibility.HIDDEN).any() or (life.state[clear] == Visibility.HIDDEN).any())


def recovery_events(history: History) -> tuple[list[Event], int]:
    """The events of a run, and the number of censored intervals."""
    events, censored = [], 0
    for object_id in history.ids():
        life = history.life(object_id)
        for interval in hidden_intervals(life, history.stamps):
            if is_censored(interval, life, history.stamps):
                censored += 1
            else:
                events.append(_event(history, life, interval))
    return events, censored


def _event(history: History, life: Life, interval: Interval) -> Event:
    stamps, hide, reappear = history.stamps, interval.hide, interval.reappear
    judged = int(np.searchsorted(stamps, stamps[reappear] + AFTER - EPS))
    since = np.arange(hide, judged + 1)
    owner = history.owner(life, hide, BEFORE)
    return Event(
        object=life.id,
        hidden_at=float(stamps[hide]),
        reappeared_at=float(stamps[reappear]),
        motion=motion_of(life, interval),
        confusers=_confusers(history, life, since),
        owner=owner,
        outcome=_outcome(history, life, owner, since),
        stolen=_stolen(history, life, owner, since),
        latency=_latency(life.partner != NONE, reappear, stamps),
        owner_latency=_latency((life.partner == owner) & (life.partner != NONE), reappear, stamps),
        coasts={} if owner is None else _coasts(history, life, owner, interval),
        nees=[] if owner is None else _nees(history, life, owner, interval),
    )


def _outcome(history: History, life: Life, owner: int | None, since: I64) -> Outcome:
    """The first that applies at the last scan of `since`."""
    if owner is None:
        return "no owner"
    astray = sum(_is_astray(history, life, owner, k) for k in since.tolist())
    if astray * history.period >= WRONG_FOR - EPS:
        return "wrong"
    partner = life.partner[since[-1]]
    if partner == owner:
        return "recovered"
    return "lost" if partner == NONE else "new id"


def _is_astray(history: History, life: Life, owner: int, scan: int) -> bool:
    """Whether the owner is inside another object's gate and nearer to it than to its own."""
    m, track = history.moments[scan], history.track(owner, scan)
    if track is None:
        return False
    distance = np.linalg.norm(m.objects.center[:, :2] - m.place[track], axis=1)
    own = m.row[life.id]
    closer = (distance <= m.gate) & (distance < distance[own])
    return bool(closer.any())


def _stolen(history: History, life: Life, owner: int | None, since: I64) -> bool:
    scans = 0
    for k in since.tolist():
        track = history.track(owner, k)
        scans += track is not None and history.moments[k].fed[track] not in (NONE, life.id)
    return scans >= STOLEN_SCANS


def _latency(is_match: Bool, reappear: int, stamps: F64) -> float:
    """Seconds to the first match from reappearing on; 3 when there is none by then."""
    later = np.flatnonzero(is_match[reappear:])
    return min(float(stamps[reappear + later[0]] - stamps[reappear]), LATENCY_LIMIT) if len(later) else 3.0


def _coasts(history: History, life: Life, owner: int, interval: Interval) -> dict[float, Coast | None]:
    coasts: dict[float, Coast | None] = {}
    stamps = history.stamps
    for after in COAST_TIMES:
        scan = int(np.searchsorted(stamps, stamps[interval.hide] + after - EPS))
        if scan >= interval.reappear:
            break
        track = history.track(owner, scan)
        if track is None:
            coasts[after] = None
            continue
        offset = history.moments[scan].place[track] - life.xy[scan]
        c, s = np.cos(life.yaw[scan]), np.sin(life.yaw[scan])
        along, across = c * offset[0] + s * offset[1], c * offset[1] - s * offset[0]
        coasts[after] = Coast(float(np.hypot(*offset)), abs(float(along)), abs(float(across)))
    return coasts


def _nees(history: History, life: Life, owner: int, interval: Interval) -> list[float]:
    values = []
    for scan in range(interval.hide, interval.reappear):
        track = history.track(owner, scan)
        if track is None or life.state[scan] != Visibility.HIDDEN:
            continue
        m = history.moments[scan]
        offset = m.place[track] - life.xy[scan]
        if np.linalg.det(m.cov[track]) > 0:
            values.append(float(offset @ np.linalg.solve(m.cov[track], offset)) / 2)
    return values


def motion_of(life: Life, interval: Interval) -> Motion:
    """How the object moved from the scan before it hid to the one in which it came out.

    standing: never above 0.5 m/s. stop-and-go: both above and below. turning: its heading swept
    more than 15 degrees. straight: the rest.
    """
    rows = slice(max(interval.hide - 1, 0), interval.reappear + 1)
    moves = life.speed[rows] > MOVING
    if not moves.any():
        return "standing"
    if not moves.all():
        return "stop-and-go"
    return "turning" if np.ptp(np.unwrap(life.yaw[rows])) > TURN else "straight"


def _confusers(history: History, life: Life, since: I64) -> int:
    near: set[int] = set()
    for k in since.tolist():
        m = history.moments[k]
        own = m.row[life.id]
        distance = np.linalg.norm(m.objects.center[:, :2] - life.xy[k], axis=1)
        near |= set(m.objects.id[distance <= m.reach[own]].tolist())
    return len(near - {life.id})
