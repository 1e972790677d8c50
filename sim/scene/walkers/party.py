"""A party: one person or several who walk together, and what they are up to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from datmo.arrays import F64
from datmo.messages import Kind
from scenarios import spec
from sim.scene.autopilot import STEP, Claim, RightOfWay
from sim.scene.roads import Road
from sim.scene.vehicles import State
from sim.scene.walkers.boxes import Boxes
from sim.scene.walkers.line import Line, Stretch
from sim.scene.walkers.sight import HORIZON, look
from sim.scene.walkers.social import TAU
from sim.scene.walkers.walker import Walker

RADIUS = 0.4  # ground a walker needs [m]
WAIT_AT = 0.4  # a walker waits this far before a road [m]
PATIENCE = 2.0  # after it, only vehicles that could not stop any more are waited for [s]
REST = 1.0  # at either end of a walk [s]
BRAKING = 1.5  # [m/s²]
ASK = 1.0  # a walker looks for a free road this far before it would have to slow down [m]
LOOK = 2.5  # it makes for the point of its line so far ahead [m]
BESIDE = 0.75  # between the lines of those who walk together [m]
WALKS, PAUSES = (2.0, 6.0), (2.0, 5.0)  # of stop-and-go, least and most [s]
WEAVE, WAVE = 0.4, 9.0  # sideways amplitude and length of a stroll's waves [m]
STILL = 0.15  # who is slower waits [m/s]
STRAY = 0.3  # who stands returns from farther away than this [m]
NEARLY, BLOCKED = 1.2, 1.0  # who stands so near the goal [m] for so long [s] has arrived
BOLD = ("jaywalking", "running-out")
"""They step on the road as soon as those who come could stop at all."""


def stream(seed: np.random.SeedSequence, index: int) -> np.random.Generator:
    """Generator `index` of a seed, whatever was drawn from the others."""
    key = (*seed.spawn_key, index)
    return np.random.default_rng(np.random.SeedSequence(seed.entropy, spawn_key=key))


class Party:
    """People who walk together: they set out, wait, cross and turn back as one.

    Args:
        walk: what the scenario says. roads: where it has to look.
        first: id of its first member. seed: of its variety, a stream for each member and the plan.
        now: [s since the first scan].
    """

    def __init__(
        self,
        walk: spec.Pedestrian,
        roads: Sequence[Road],
        first: int,
        seed: np.random.SeedSequence,
        now: float,
    ) -> None:
        self.walk = walk
        leader = Walker(walk, first, np.random.default_rng(seed), None)
        rest = [Walker(walk, first + i, stream(seed, i), leader.pace) for i in range(1, walk.group)]
        self.members = [leader, *rest]
        self._rng = stream(seed, 0)
        self.line = Line(np.array(walk.start), np.array(walk.goal))
        for i, one in enumerate(self.members):
            one.aside = leader.spread + BESIDE * (i - (walk.group - 1) / 2)
            one.xy = one.home = self.line.at(0.0, one.aside, 1)
            one.yaw = float(np.arctan2(*self.line.ahead(1)[::-1]))
        self.crossings = self.line.crossings(roads, [one.aside for one in self.members])
        self.way, self.rest, self.waited = 1, walk.begin - now, 0.0
        self._early = ASK + max(one.pace for one in self.members) ** 2 / (2 * BRAKING)
        self._spell, self._wave = float(self._rng.uniform(*WALKS)), float(self._rng.uniform(0, 2 * np.pi))
        self._armed = walk.trigger is not None
        self.open: Stretch | None = None
        on = [c for c in self.crossings if c[0] - WAIT_AT / 2 < 0 < c[1]]
        self.open = on[0] if on else None

    @property
    def going(self) -> bool:
        """Whether it wants to walk now."""
        return self.rest == 0 and not self._armed and self.walk.behaviour != "waiting"

    def plan(self, dt: float, way: RightOfWay, vehicles: Sequence[State]) -> None:
        """Set out, pause, step on the road, turn back: what changes in `dt` seconds.

        Args:
            vehicles: the ego first.
        """
        self.rest = max(self.rest - dt, 0.0)
        if self.rest == 0 and self._armed:
            self._armed = not self._startled(vehicles)
        if not self.going:
            self.waited = 0.0
            return
        still = all(one.speed < STILL for one in self.members)
        self.waited = self.waited + dt if still else 0.0
        if self.walk.behaviour == "stop-and-go":
            self._pause(dt)
        self._cross(way)
        left = [self.line.length - self._along(one) for one in self.members]
        if still and (max(left) < 0.05 or (max(left) < NEARLY and self.waited > BLOCKED)):
            self._arrive()

    def wish(self, one: Walker, boxes: Boxes) -> F64:
        """The velocity (2,) a member would like, past `boxes` that stand."""
        if not self.going:
            back = one.home - one.xy
            far = float(np.hypot(back[0], back[1]))
            return back * (min(one.pace, max(far - STRAY, 0.0)) / max(far, 1e-9))
        one.home = one.xy + TAU * one.velocity
        along, limit = self._along(one), self.limit(one)
        ahead = min(along + LOOK, self.line.length)
        to = self.line.at(ahead, one.aside + self._weave(ahead), self.way) - one.xy
        far = float(np.hypot(to[0], to[1]))
        if min(limit, far) < 1e-6:
            return np.zeros(2)
        pace = min(one.pace, float(np.sqrt(2 * BRAKING * limit)))
        goal = self.line.at(along + min(limit, HORIZON), one.aside, self.way)
        return look(one.xy, to / far, goal, pace, boxes)

    def held(self, one: Walker, velocity: F64, dt: float) -> F64:
        """What is left of a velocity (2,) before a kerb or the end of the walk."""
        ahead, limit = self.line.ahead(self.way), self.limit(one)
        reached = max(2 * limit / dt - float((one.velocity * ahead).sum()), 0.0)
        most = min(float(np.sqrt(2 * BRAKING * limit)), reached)
        over = float((velocity * ahead).sum()) - most
        return velocity - ahead * max(over, 0.0)

    def limit(self, one: Walker) -> float:
        """How far a member may walk on [m]; a road is stepped on only when it is open."""
        along = self._along(one)
        for stretch in self._stretches():
            if along < stretch[1] and stretch != self.open:
                return max(stretch[0] - WAIT_AT - along, 0.0)
        return max(self.line.length - along, 0.0)

    def claim(self, xy: F64) -> Claim:
        """The rest of the road a member at `xy` (2,) is crossing, or the place alone."""
        along = self.line.along(xy, self.way)
        end = max(along, self.open[1]) if self.open else along
        s = np.arange(0.0, end - along + STEP, STEP)
        return Claim(xy + s[:, None] * self.line.ahead(self.way), RADIUS, walker=True)

    @property
    def facing(self) -> float:
        """Where its members look while they stand [rad]."""
        return float(np.arctan2(*self.line.ahead(self.way)[::-1]))

    def _along(self, one: Walker) -> float:
        return self.line.along(one.xy, self.way)

    def _stretches(self) -> list[Stretch]:
        return self.line.stretches(self.crossings, self.way)

    def _startled(self, vehicles: Sequence[State]) -> bool:
        trigger = self.walk.trigger
        if trigger is None:
            return True
        watched = vehicles[:1] if trigger.of == "ego" else vehicles
        watched = [v for v in watched if v.body.kind != Kind.PEDESTRIAN]
        centre = np.mean([one.xy for one in self.members], 0)
        return any(np.hypot(*(v.xy - centre)) < trigger.distance for v in watched)

    def _pause(self, dt: float) -> None:
        self._spell -= dt
        if self._spell <= 0:
            self.rest = float(self._rng.uniform(*PAUSES))
            self._spell = float(self._rng.uniform(*WALKS))

    def _cross(self, way: RightOfWay) -> None:
        """Close the road behind all, and open the next one when its ground is free for all."""
        along = [self._along(one) for one in self.members]
        if self.open and min(along) >= self.open[1]:
            self.open = None
        coming = [s for s in self._stretches() if min(along) < s[1]]
        if self.open or not coming or min(along) < coming[0][0] - WAIT_AT - self._early:
            return
        self.open = coming[0]
        at_ease = self.waited < PATIENCE and self.walk.behaviour not in BOLD
        points = np.concatenate([self.claim(one.xy).points for one in self.members])
        if not way.may_step(Claim(points, RADIUS, walker=True), at_ease):
            self.open = None

    def _arrive(self) -> None:
        self.way, self.open, self.waited = -self.way, None, 0.0
        self.rest = np.inf if self.walk.behaviour == "running-out" else REST
        if self.walk.behaviour == "running-out":
            self.way = 1

    def _weave(self, along: float) -> float:
        if self.walk.behaviour != "strolling":
            return 0.0
        calm = min(along, self.line.length - along, 3.0) / 3.0
        return WEAVE * calm * float(np.sin(2 * np.pi * along / WAVE + self._wave))
