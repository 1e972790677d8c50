"""The crowd: all people on foot of an episode, who keep off each other and off what drives and stands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from datmo.arrays import F64
from datmo.errors import ScenarioError
from datmo.messages import Kind
from scenarios import spec
from sim.scene.autopilot import RightOfWay
from sim.scene.roads import Road
from sim.scene.vehicles import State
from sim.scene.walkers.boxes import Boxes, join, of_states
from sim.scene.walkers.contact import keep_out, part
from sim.scene.walkers.party import RADIUS, Party
from sim.scene.walkers.social import FASTEST, avoid, relax, shun, together
from sim.scene.walkers.walker import Walker

FIRST_ID = 101
LAST_ID = 999  # vehicles of traffic come after
DRIVES = 0.1  # what is slower than this stands [m/s]
NOTHING = join([])


class Crowd:
    """All walkers of a scenario.

    Args:
        walks: of the scenario. roads: where walkers have to look. seeds: one a walk, of its variety.
        now: [s since the first scan].

    Raises:
        ScenarioError: there are more people than ids for them.
    """

    def __init__(
        self,
        walks: Sequence[spec.Pedestrian],
        roads: Sequence[Road],
        seeds: Sequence[np.random.SeedSequence],
        now: float,
    ) -> None:
        first = FIRST_ID + np.cumsum([0, *(walk.group for walk in walks)])
        if first[-1] > LAST_ID + 1:
            raise ScenarioError(
                f"pedestrians are {first[-1] - FIRST_ID} people in all; at most "
                f"{LAST_ID + 1 - FIRST_ID} have ids; make groups smaller"
            )
        self.parties = [
            Party(walk, roads, int(name), seed, now)
            for walk, name, seed in zip(walks, first[:-1], seeds, strict=True)
        ]
        self.walkers = [one for party in self.parties for one in party.members]
        self._party = [party for party in self.parties for _ in party.members]
        self._group = np.array([i for i, p in enumerate(self.parties) for _ in p.members], np.int64)

    def states(self) -> list[State]:
        """Where everyone is."""
        return [one.state() for one in self.walkers]

    def place(self, right_of_way: RightOfWay) -> None:
        """Claim the ground that everyone stands on or is about to cross."""
        for party, one in zip(self._party, self.walkers, strict=True):
            right_of_way.place(one.name, party.claim(one.xy))

    def step(
        self, dt: float, right_of_way: RightOfWay, others: Sequence[State] = (), things: Boxes = NOTHING
    ) -> None:
        """Walk for `dt` seconds, and claim the ground to be walked on.

        Args:
            others: all other actors, the ego first. things: that stand about.
        """
        if not self.walkers:
            return
        for party in self.parties:
            party.plan(dt, right_of_way, others)
        driving = of_states([s for s in others if s.body.kind != Kind.PEDESTRIAN])
        boxes = join([driving, things])
        strangers = [s for s in others if s.body.kind == Kind.PEDESTRIAN]
        points, reach = _threat(right_of_way, others)
        wanted = self._wanted(dt, boxes, strangers, _flight(self.walkers, points, reach))
        for party, one, velocity in zip(self._party, self.walkers, wanted, strict=True):
            safe = party.held(one, one.capped(velocity), dt)
            one.move(_permitted(party, one, safe, points, reach, dt), party.facing, dt)
        self.place(right_of_way)

    def _wanted(self, dt: float, boxes: Boxes, strangers: Sequence[State], flight: F64) -> F64:
        """Velocities (n, 2) after wishes, social forces and contacts."""
        n = len(self.walkers)
        standing = boxes.only(boxes.speed() < DRIVES)
        wish = np.array([p.wish(one, standing) for p, one in zip(self._party, self.walkers, strict=True)])
        wish = np.where(np.isnan(flight), wish, flight)
        xy = np.array([one.xy for one in self.walkers] + [s.xy for s in strangers])
        v = np.array([one.velocity for one in self.walkers] + [s.velocity for s in strangers])
        bodies = [one.body for one in self.walkers] + [s.body for s in strangers]
        half = np.array([(b.length / 2, b.width / 2) for b in bodies])
        force = avoid(xy, v)[:n] + together(xy[:n], v[:n], self._group)
        if len(boxes):
            force = force + shun(boxes.gap(xy[:n]))
        v[:n] = relax(v[:n], wish, force, dt)
        everyone = zip(self._party, self.walkers, v[:n], strict=True)
        turned = [one.turned(own, party.facing, dt) for party, one, own in everyone]
        yaw = np.array([*turned, *(s.yaw for s in strangers)])
        v = part(xy, v, yaw, half, np.arange(len(xy)) < n, dt)
        return keep_out(xy[:n], v[:n], boxes, dt)


def _threat(right_of_way: RightOfWay, others: Sequence[State]) -> tuple[F64, F64]:
    """Ground (m, 2) that moving vehicles would still pass if they braked, and its radii (m,) [m]."""
    moving = [s.id for s in others if np.hypot(*s.velocity) > DRIVES]
    claims = [right_of_way.brake[i] for i in moving if i in right_of_way.brake]
    points = np.concatenate([np.zeros((0, 2)), *(c.points for c in claims)])
    return points, np.concatenate([np.zeros(0), *(np.full(len(c.points), c.radius) for c in claims)])


def _flight(walkers: Sequence[Walker], points: F64, reach: F64) -> F64:
    """Where to and how fast (n, 2) [m/s] those flee who stand where a vehicle will be; NaN for all others.

    Vehicles of the traffic stop before people; scripts do not, nor may an agent.
    """
    wish = np.full((len(walkers), 2), np.nan)
    for i, one in enumerate(walkers):
        away = one.xy - points
        away = away[np.hypot(away[:, 0], away[:, 1]) < reach + RADIUS]
        if len(away):
            right = np.array([np.sin(one.yaw), -np.cos(one.yaw)])
            out = away.mean(0) + 0.05 * right  # who stands in the very middle goes to the right
            wish[i] = out * (FASTEST * one.pace / max(float(np.hypot(*out)), 1e-9))
    return wish


def _permitted(party: Party, one: Walker, velocity: F64, points: F64, reach: F64, dt: float) -> F64:
    """A velocity (2,) that leads onto no ground a vehicle needs to stop.

    The rest of an open road is the walker's own: straight on is always allowed there.
    """

    def free(v: F64) -> bool:
        mine = party.claim(one.xy + (one.velocity + v) / 2 * dt).points
        apart = np.hypot(*(mine[:, None] - points[None]).transpose(2, 0, 1))
        return bool((apart >= reach + RADIUS).all())

    still = np.zeros(2)
    if free(velocity) or not free(-one.velocity):  # or it stands on such ground already, and leaves it
        return velocity
    ahead = party.line.ahead(party.way)
    straight = ahead * max(float((velocity * ahead).sum()), 0.0)
    return straight if party.open or free(straight) else still
