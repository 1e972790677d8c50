"""Which vehicles there are: those of the start, and those that come later from beyond the range."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, Bool
from sim.scene.autopilot import FIRM, GAP, Mover, RightOfWay, braking, stretch
from sim.scene.course import Course, Key, Lane, follow
from sim.scene.vehicles import FLEET, Body, Places, body

FIRST_ID = 1001
LOOK = 70.0  # the way ahead that the right of way is told [m]
ONWARD = 500.0  # a new vehicle's course is at least this long where the road allows [m]
OUTSIDE = 8.0  # beyond the sensor's range, vehicles appear and vanish [m]
STOCK = 60.0  # width of the ring out there in which the next ones wait [m]
SPARE = 4  # more than asked for, at the start: some leave before others come
AHEAD = 50.0  # the vehicles of the start are within range of the ego's start and of this far on [m]
PACE = 0.8  # of the lane's limit
DENSER, SLOW = (1.0, 0.7, 0.5), 8.0
"""Where a vehicle does not fit it comes slower, as in dense traffic, but not below SLOW [m/s]."""


@dataclass(frozen=True, eq=False)
class Arrival:
    """A vehicle about to be: its course, and where it is on the first lane [m], at which speed [m/s]."""

    id: int
    course: Course
    arc: float
    speed: float
    body: Body


def asking(
    name: int, looks: Body, course: Course, rear: float, speed: float, wish: float, before: float, first: bool
) -> Mover:
    """What the right of way has to know of a vehicle whose rear bumper is `rear` metres along its course."""
    behind = max(rear, 0.0)
    path = course.ahead(behind, looks.length + LOOK)
    zone = course.zone(behind)
    return Mover(name, path, looks.length, looks.width, max(speed, 0.0), wish, before, zone, first)


class Population:
    """Keeps about `count` vehicles within `reach` of the ego; they appear beyond it only.

    Args:
        lanes: by key. limits: their speed limits [m/s]. way: where new vehicles claim their ground.
        count: vehicles wanted within range. reach: the sensor's range [m]. rng: of every choice.
    """

    def __init__(
        self,
        lanes: Mapping[Key, Lane],
        limits: Mapping[Key, float],
        way: RightOfWay,
        count: int,
        reach: float,
        rng: np.random.Generator,
    ) -> None:
        self._lanes, self._limits, self._way, self._rng = lanes, limits, way, rng
        self._count, self._reach = count, reach
        self._names = {key: i for i, key in enumerate(lanes)}
        self._places = Places(lanes)
        self._made = 0

    def clear(self, key: Key, low: float, high: float) -> Bool:
        """Places (m,) on a lane between two arc lengths [m]: those to leave free."""
        return self._places.on(key, low, high)

    def begin(self, start: F64, direction: F64, clear: Bool) -> list[Arrival]:
        """The vehicles of the start, none at the places `clear`.

        Args:
            start: (2,) of the ego at the first scan [m, world]. direction: (2,) in which it goes.
        """
        later = start + AHEAD * direction
        most = self._count + SPARE if self._count else 0
        here = self._places.within(start, 0, self._reach - 10) & ~clear
        there = self._places.within(later, 0, self._reach - 10) & ~clear
        found = self._fill(here & ~there & self._places.towards(start), most // 6)  # behind the ego
        found += self._fill(here & there, most // 2)
        found += self._fill(there & self._places.towards(later), most - len(found))
        return [*found, *self.refill(start, len(found), 0, clear)]

    def gone(self, distance: float) -> bool:
        """Whether a vehicle at this distance from the ego [m] is out of the world."""
        return distance > self._reach + OUTSIDE + STOCK

    def refill(self, centre: F64, inside: int, waiting: int, clear: Bool) -> list[Arrival]:
        """Vehicles that come next, in a ring beyond the range around the ego.

        Half as many as are wanted wait there, or as many as are missing within range if that is more.

        Args:
            centre: (2,) of the ego [m, world]. inside: vehicles within range.
            waiting: vehicles that are out there already.
        """
        missing = max((self._count + 1) // 2, self._count - inside) - waiting
        if missing <= 0:
            return []
        low = self._reach + OUTSIDE
        ring = self._places.within(centre, low, low + STOCK - 10) & self._places.towards(centre) & ~clear
        return self._fill(ring, missing)

    def waiting(self, distance: float) -> bool:
        """Whether a vehicle at this distance from the ego [m] is in the ring or beyond it."""
        return distance > self._reach + OUTSIDE

    def _fill(self, where: Bool, count: int) -> list[Arrival]:
        """Up to `count` new vehicles at some of the places; fewer where they do not fit."""
        found: list[Arrival] = []
        left = where.copy()
        while len(found) < count and left.any():
            choice = np.flatnonzero(left)
            i = int(choice[self._rng.integers(len(choice))])
            made = self._appear(i)
            found += made
            around = 10.0 if made else 3.0
            arc = self._places.arc
            left &= (self._places.lane != self._places.lane[i]) | (np.abs(arc - arc[i]) > around)
        return found

    def _appear(self, i: int) -> list[Arrival]:
        """A new vehicle at place i, or none where somebody has, or needs, the ground."""
        key, arc = self._places.keys[self._places.lane[i]], float(self._places.arc[i])
        limit = self._limits[key]
        speed = float(np.clip(PACE * limit + self._rng.normal(), 0.5 * limit, limit))
        looks = body(FLEET[int(self._rng.integers(len(FLEET)))])
        course = Course(follow(self._lanes, [key], arc + ONWARD, self._rng), self._names)
        name = FIRST_ID + self._made
        self._made += 1  # an id is never given twice
        for slower in DENSER:
            if slower < 1 and slower * speed < SLOW:
                break
            made = Arrival(name, course, arc, slower * speed, looks)
            mover = asking(name, looks, course, arc - looks.length / 2, made.speed, 0.0, 0.0, False)
            need = looks.length + braking(made.speed, FIRM) + GAP
            claim = stretch(mover, 0.0, need)
            if not (mover.zone and mover.zone[0] < need) and self._way.free(claim):
                self._way.place(name, claim)
                return [made]
        return []
