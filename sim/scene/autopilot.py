"""Right of way: who may drive on, by how much, so that nobody ever drives into anybody.

Everything that moves *claims* ground: a vehicle its body and the way it needs to brake, a walker
the rest of the road it is crossing, a parked thing the place it stands on. A vehicle takes only
ground that no one else claims, one vehicle after the other, so that claims stay disjoint and the
brake it has claimed the way for is always enough. A crossing is claimed as a whole before it is
entered, so that nobody has to stop inside. The ego's autopilot obeys the same rule.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numba import njit

from datmo.arrays import F64

STEP = 0.5
"""Spacing of the points of a path [m]."""

MARGIN = 0.25  # beside a body [m]
GAP = 1.0  # kept to what is in the way [m]
COMFORT = 2.0  # usual braking [m/s²]
FIRM = 3.5  # braking that claims are made for [m/s²]
HARD = 5.0  # most braking [m/s²]
REACT = 0.25  # [s]
JERK = 12.0  # of usual driving [m/s³]
FORESIGHT = 1.5  # who goes first asks this much earlier [s]
TAU = 0.5  # of the approach to the allowed speed [s]


@njit(cache=True, nogil=True)
def _first_touch(path: F64, points: F64, reach: F64) -> int:
    """Index of the first path point nearer to points[j] than reach[j], or len(path)."""
    for i in range(len(path)):
        for j in range(len(points)):
            dx, dy = path[i, 0] - points[j, 0], path[i, 1] - points[j, 1]
            if dx * dx + dy * dy < reach[j] * reach[j]:
                return i
    return len(path)


@dataclass(frozen=True)
class Claim:
    """Ground that belongs to someone for now: discs of one radius [m] around points (n, 2) [m, world].

    `zone` names the way through a crossing that the owner is on, -1 for none. A `walker` soon
    leaves its ground: its claim behind a crossing keeps nobody from entering.
    """

    points: F64
    radius: float
    zone: int = -1
    walker: bool = False


@dataclass(frozen=True)
class Mover:
    """A vehicle that asks for its way.

    Attributes:
        path: (m, 2) points every `STEP` along its way, the first at its rear bumper [m, world].
        speed: [m/s]. wish: acceleration it would like [m/s²]. before: the one it had [m/s²].
        zone: start and end of the next crossing on the path [m from the rear], and its name.
        first: goes before all others.
    """

    id: int
    path: F64
    length: float
    width: float
    speed: float
    wish: float
    before: float = 0.0
    zone: tuple[float, float, int] | None = None
    first: bool = False


def stretch(mover: Mover, start: float, end: float, zone: int = -1) -> Claim:
    """The ground under a mover between two places on its path [m from the rear bumper]."""
    radius = mover.width / 2 + MARGIN
    i = max(int((start + mover.width / 2) / STEP), 0)
    j = max(int(np.ceil((end - mover.width / 2) / STEP)), i)
    return Claim(mover.path[i : j + 1], radius, zone)


def room(mover: Mover, others: Iterable[Claim]) -> float:
    """How far the front bumper may go before the mover touches a claim of others [m]."""
    claims = [c for c in others if len(c.points)]
    if not claims:
        return float(len(mover.path) * STEP - mover.length)
    points = np.concatenate([c.points for c in claims])
    reach = np.repeat([c.radius for c in claims], [len(c.points) for c in claims])
    nose = max(int((mover.length - mover.width / 2) / STEP), 0)
    touch = nose + _first_touch(mover.path[nose:], points, reach + mover.width / 2 + MARGIN)
    return max((touch - 1) * STEP + mover.width / 2 - mover.length, 0.0)


def braking(speed: float, deceleration: float) -> float:
    """Way from seeing to standing [m]."""
    return speed * REACT + speed**2 / (2 * deceleration)


def choose(mover: Mover, free: float, dt: float) -> float:
    """The acceleration [m/s²] that gets on, comfortably where it can, within `free` metres."""
    allowed = np.sqrt(2 * COMFORT * max(free - GAP, 0.0))
    a = min(mover.wish, (allowed - mover.speed) / TAU - COMFORT)  # follows `allowed` down without lag
    a = float(np.clip(a, mover.before - JERK * dt, mover.before + JERK * dt))
    after = max(mover.speed + a * dt, 0.0)
    if mover.speed * dt + braking(after, FIRM) > free:
        a = min(a, -max(mover.speed**2 / (2 * max(free - mover.speed * dt, 0.1)), COMFORT))
    return max(min(a, HARD), -HARD, -mover.speed / dt)


@dataclass
class RightOfWay:
    """Who claims which ground.

    Attributes:
        held: what each owner has for certain; disjoint among vehicles.
        brake: what a vehicle would still pass if it braked firmly; part of what it holds.
        ahead: what it would still pass if it braked at ease.
        crossing: the rest of the way through a crossing of those who were let in.
    """

    held: dict[int, Claim] = field(default_factory=dict)
    brake: dict[int, Claim] = field(default_factory=dict)
    ahead: dict[int, Claim] = field(default_factory=dict)
    crossing: dict[int, Claim] = field(default_factory=dict)

    def place(self, owner: int, claim: Claim) -> None:
        """Claim ground for someone who does not ask: a walker, a script, a parked thing."""
        self.held[owner] = claim
        if not claim.walker:
            self.brake[owner] = claim

    def keep(self, owners: Iterable[int]) -> None:
        """Forget everyone else."""
        known = set(owners)
        for claims in (self.held, self.brake, self.ahead, self.crossing):
            for owner in set(claims) - known:
                del claims[owner]

    def free(self, claim: Claim) -> bool:
        """Whether nobody holds, or is about to reach, the ground of a claim."""
        return not any(_touch(claim, c) for c in (*self.held.values(), *self.ahead.values()))

    def may_step(self, claim: Claim, at_ease: bool) -> bool:
        """Whether no vehicle is too near to stop before the ground of a walker's claim.

        At ease, vehicles in a crossing must be able to leave it, and others to stop comfortably.
        """
        courtesy = (*self.held.values(), *self.ahead.values()) if at_ease else ()
        near = (*self.brake.values(), *(c for c in courtesy if not c.walker))
        return not any(_touch(claim, c) for c in near)

    def decide(self, movers: Sequence[Mover], dt: float) -> dict[int, float]:
        """The acceleration of each mover [m/s²] for the next `dt` seconds; claims move along."""
        waiting: list[Claim] = []
        return {m.id: self._decide(m, waiting, dt) for m in sorted(movers, key=_rank)}

    def _decide(self, mover: Mover, waiting: list[Claim], dt: float) -> float:
        others = [c for owner, c in self.held.items() if owner != mover.id]
        free = room(mover, others)
        look = braking(mover.speed, COMFORT) + GAP
        held_up = self._cross(mover, others, look, waiting)
        limit = min(free, mover.zone[0] - mover.length) if mover.zone and held_up else free
        a = choose(mover, limit, dt)
        after = max(mover.speed + a * dt, 0.0)
        zone = mover.zone[2] if mover.zone and mover.id in self.crossing else -1
        reach = mover.speed * dt + braking(after, FIRM)
        self.brake[mover.id] = stretch(mover, 0.0, mover.length + min(reach, free))
        if mover.id in self.crossing and mover.zone:
            reach = max(reach, mover.zone[1])
        self.held[mover.id] = stretch(mover, 0.0, mover.length + min(reach, free), zone)
        self.ahead[mover.id] = stretch(mover, 0.0, mover.length + min(look, limit))
        return a

    def _cross(self, mover: Mover, others: Sequence[Claim], look: float, waiting: list[Claim]) -> bool:
        """Whether the mover has to wait before the next crossing; if let in, it is noted."""
        early = FORESIGHT * mover.speed if mover.first else 0.0
        if mover.zone is None or mover.length + look + early < mover.zone[0]:
            self.crossing.pop(mover.id, None)
            return False
        start, end, name = mover.zone
        if mover.length > start:  # inside; what lies behind is free again
            if mover.id in self.crossing:
                self.crossing[mover.id] = stretch(mover, 0.0, end + mover.length, name)
            return False
        whole = stretch(mover, start, end + mover.length, name)
        inside = [c for owner, c in self.crossing.items() if owner != mover.id]
        strangers = [c for c in (*others, *inside, *waiting) if c.zone != name]
        staying = [c for c in strangers if not c.walker]
        if room(mover, staying) >= end and room(mover, strangers) >= end - mover.length:
            self.crossing[mover.id] = whole
            return False
        if mover.id in self.crossing and braking(mover.speed, FIRM) > start - mover.length:
            return False  # let in before, and too late to stop
        self.crossing.pop(mover.id, None)
        waiting.append(whole)
        return mover.length + look >= start


def _rank(mover: Mover) -> tuple[bool, float, int]:
    return not mover.first, mover.zone[0] if mover.zone else np.inf, mover.id


def _touch(a: Claim, b: Claim) -> bool:
    if not len(a.points) or not len(b.points):
        return False
    reach = np.full(len(b.points), a.radius + b.radius)
    return _first_touch(a.points, b.points, reach) < len(a.points)
