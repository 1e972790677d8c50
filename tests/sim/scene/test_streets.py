"""People among the traffic of a whole world."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.geometry import corners_bev, overlap_bev
from scenarios.spec import Scenario
from sim.scene.vehicles import State
from sim.scene.world import World

STREET = Scenario.model_validate(
    {
        "name": "street",
        "duration": 9.0,
        "terrain": {"cell": 2.0},
        "sensor": {"range": 60.0},
        "traffic": {"environment": None, "vehicles": 14},
        "ego": {"speed": 8.0, "start": 60},
        "pedestrians": (
            {"behaviour": "jaywalking", "start": (6.0, 10.0), "goal": (-6.0, 10.0)},
            {"behaviour": "jaywalking", "start": (-6.0, -25.0), "goal": (6.0, -25.0), "speed": 1.0},
            {
                "behaviour": "running-out",
                "start": (7.5, -8.0),
                "goal": (-6.0, -8.0),
                "trigger": {"distance": 20.0},
                "age": "child",
            },
            {"start": (6.0, 20.0), "goal": (-6.0, 20.0), "group": 3},
            {"behaviour": "strolling", "start": (-6.5, -20.0), "goal": (-6.5, 30.0), "group": 2},
        ),
        "actors": ({"name": "van", "kind": "van", "path": ({"t": 0, "x": 6.8, "y": -12.0},), "yaw_deg": 90},),
    }
)


def states_of(world: World) -> list[State]:
    """All states after every step of an episode."""
    seen: list[list[State]] = []
    play = world._play

    def listened() -> list[list[State]]:
        knots = play()
        seen.extend(knots[1:])
        return knots

    world._play = listened  # type: ignore[method-assign]
    world.reset()
    for _ in range(STREET.scans - 1):
        world.advance()
    return seen  # type: ignore[return-value]


def overlap(a: State, b: State) -> float:
    if np.hypot(*(a.xy - b.xy)) > 8:
        return 0.0
    size = np.array([(s.body.length, s.body.width) for s in (a, b)])
    return overlap_bev(*corners_bev(np.array([a.xy, b.xy]), size, np.array([a.yaw, b.yaw])))


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2, 3))])
def test_nobody_is_run_over_and_those_who_come_brake(seed: int) -> None:
    world = World(STREET, np.random.SeedSequence(seed))
    knots = states_of(world)
    assert not world.crashed
    speeds: dict[int, list[float]] = {}
    for states in knots:
        people = [s for s in states if 100 < s.id < 1000]
        for one in people:
            for other in states:
                if other.id != one.id:
                    share = overlap(one, other)
                    assert share <= (0.1 if other in people else 0.0), (one.id, other.id)
        for s in states:
            if s.id == 0 or s.id > 1000:
                speeds.setdefault(s.id, []).append(float(np.hypot(*s.velocity)))
    hardest = min(np.diff(v).min() for v in speeds.values() if len(v) > 1) * 20
    assert hardest < -2.5
    ways = [np.array([s.xy for states in knots for s in states if s.id == i]) for i in (101, 102)]
    assert max(np.ptp(way[:, 0]) for way in ways) > 9


def test_walkers_do_not_change_the_luck_of_the_first() -> None:
    fewer = STREET.model_copy(update={"pedestrians": STREET.pedestrians[:1]})
    worlds = [World(scenario, np.random.SeedSequence(3)) for scenario in (fewer, STREET)]
    for world in worlds:
        world.reset()
    a, b = (next(s for s in w._states() if s.id == 101) for w in worlds)
    assert a.body.asset == b.body.asset
    np.testing.assert_allclose(a.xy, b.xy, atol=1e-6)  # they feel each other from afar
