"""Nobody begins inside another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.errors import ScenarioError
from datmo.geometry import corners_bev
from scenarios.spec import Scenario
from sim.scene.scenery.plot import foot
from sim.scene.vehicles import State
from sim.scene.walkers.party import BESIDE, Party

SHOULDERS = 0.5  # of a person, across [m]


@dataclass(frozen=True, eq=False)
class Footprint:
    """The ground under something with a name: corners (4, 2) [m, world]."""

    name: str
    corners: F64


def check(scenario: Scenario, scripted: Sequence[State], parties: Sequence[Party]) -> None:
    """Refuse actors at the first scan, and people where they set out, inside each other or inside things.

    Raises:
        ScenarioError: names both, how far they overlap, and what to do.
    """
    begins = [*_actors(scenario, scripted), *(_start(i, party) for i, party in enumerate(parties))]
    for i, one in enumerate(begins):
        _refuse(one, [*begins[i + 1 :], *_things(scenario)])


def check_ego(scenario: Scenario, ego: State, scripted: Sequence[State]) -> None:
    """The same of the ego at the first scan."""
    _refuse(_footprint("the ego", ego), [*_actors(scenario, scripted), *_things(scenario)])


def _actors(scenario: Scenario, scripted: Sequence[State]) -> list[Footprint]:
    return [_footprint(f"actor {a.name!r}", s) for a, s in zip(scenario.actors, scripted, strict=True)]


def _things(scenario: Scenario) -> list[Footprint]:
    return [Footprint(f"thing {i} ({t.kind})", foot(t)) for i, t in enumerate(scenario.things)]


def _footprint(name: str, state: State) -> Footprint:
    size = np.array([[state.body.length, state.body.width]])
    return Footprint(name, corners_bev(state.xy[None], size, np.array([state.yaw]))[0])


def _start(number: int, party: Party) -> Footprint:
    """Of where people set out, as the scenario says: a group abreast."""
    size = np.array([[SHOULDERS, SHOULDERS + BESIDE * (len(party.members) - 1)]])
    corners = corners_bev(party.line.start[None], size, np.array([party.facing]))[0]
    return Footprint(f"pedestrian {number}", corners)


def _refuse(one: Footprint, others: Sequence[Footprint]) -> None:
    for other in others:
        depth = shared(one.corners, other.corners)
        if depth > 0:
            apart = float(np.hypot(*(one.corners.mean(0) - other.corners.mean(0))))
            raise ScenarioError(
                f"{one.name} begins inside {other.name}: their middles are {apart:.2f} m apart and they "
                f"overlap by {depth:.2f} m; bodies must begin clear of one another; "
                f"move one of them by more than {depth:.2f} m"
            )


def shared(a: F64, b: F64) -> float:
    """How far one of two rectangles (4, 2) must move to leave the other [m]; not above 0: they are clear."""
    if np.hypot(*(a.mean(0) - b.mean(0))) > np.hypot(*(a[0] - a[2])) / 2 + np.hypot(*(b[0] - b[2])) / 2:
        return 0.0
    sides = np.concatenate([a[1:3] - a[:2], b[1:3] - b[:2]])
    axes = sides / np.hypot(sides[:, 0], sides[:, 1])[:, None]
    on_a, on_b = ((axes[:, None] * corners).sum(-1) for corners in (a, b))
    return float(np.minimum(on_a.max(1) - on_b.min(1), on_b.max(1) - on_a.min(1)).min())
