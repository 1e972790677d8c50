from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.spaces import Box, Discrete

from datmo.errors import ScenarioError
from scenarios.load import load
from scenarios.spec import Scenario
from sim.scene.flow import Traffic
from sim.scene.traffic import action_space, quiet

DT = 0.05


def scenario(**more: Any) -> Scenario:
    return Scenario.model_validate(
        {"name": "t", "traffic": {"vehicles": 8, "warm_up": 0.0}, "ego": {"start": 41.0}, **more}
    )


def traffic(seed: int = 0, **more: Any) -> Traffic:
    made = Traffic(scenario(**more), np.random.SeedSequence(seed))
    made.populate()
    return made


def rows(made: Traffic, sweeps: int) -> bytes:
    found = []
    for _ in range(sweeps):
        made.refresh()
        for _ in range(2):
            made.step(DT)
        found += [(s.id, *s.xy, s.yaw, *s.velocity, s.yaw_rate) for s in (made.ego_state(), *made.states())]
    return np.array(found).tobytes()


@pytest.mark.long
def test_one_seed_one_traffic_whatever_ran_before() -> None:
    first = rows(traffic(3), 25)
    with quiet():
        for name in ("intersection-v0", "highway-v0"):
            gym.make(name).reset(seed=1)
    rows(traffic(4), 3)
    assert rows(traffic(3), 25) == first
    assert rows(traffic(4), 25) != first


@pytest.mark.long
def test_the_ego_position_of_highway_env_does_not_depend_on_what_ran_before() -> None:
    highway = {"environment": "highway-v0", "vehicles": 2, "warm_up": 0.0}
    first = rows(traffic(3, traffic=highway, ego={}), 2)
    rows(traffic(3), 1)
    assert rows(traffic(3, traffic=highway, ego={}), 2) == first


def test_vehicles_keep_to_lanes_and_limits() -> None:
    made = traffic(1)
    before: dict[int, float] = {}
    for _ in range(100):
        made.step(DT)
        for d in [*made.drivers, made.ego]:
            _, lateral = d.lane.local_coordinates(d.position)
            assert abs(lateral) < 0.8
            a = float(d.action["acceleration"])
            assert abs(a) <= 5.0
            assert -1e-6 <= d.speed < 10.5
            assert abs(a - before.get(d.name, a)) < 5.1
            before[d.name] = a


def test_the_state_is_the_mirror_of_highway_envs_and_its_rates_are_its_motion() -> None:
    made = traffic(2)
    for _ in range(40):
        made.step(DT)
    old = {s.id: s for s in made.states()}
    driver = made.drivers[0]
    np.testing.assert_allclose(old[driver.name].xy, driver.position * (1, -1))
    assert old[driver.name].yaw == -driver.heading
    made.step(DT / 100)
    for s in made.states():
        np.testing.assert_allclose((s.xy - old[s.id].xy) / (DT / 100), s.velocity, atol=0.3)
        assert (s.yaw - old[s.id].yaw) / (DT / 100) == pytest.approx(s.yaw_rate, abs=0.1)


def test_looks_last_a_life() -> None:
    made, looks = traffic(5), {}
    for _ in range(30):
        made.refresh()
        made.step(DT)
        for s in made.states():
            assert looks.setdefault(s.id, s.body) == s.body
    assert len({b.asset for b in looks.values()}) > 2


def test_the_ego_starts_where_it_is_told_and_follows_its_route() -> None:
    made = traffic(0, traffic={"vehicles": 0, "warm_up": 2.0, "config": {"destination": "o2"}})
    for _ in range(42):
        made.step(DT)
    np.testing.assert_allclose(made.ego_state().xy, [2.0, -52.0], atol=0.2)
    for _ in range(300):
        made.step(DT)
    assert made.ego_state().xy[0] == pytest.approx(2.0, abs=0.1)
    assert made.ego_state().xy[1] > 60
    assert not made.arrived
    for _ in range(120):
        made.step(DT)
    assert made.arrived


def test_a_parked_ego_stands_and_an_agent_acts() -> None:
    parked = traffic(0, ego={"control": "parked", "start": 41.0})
    for _ in range(20):
        parked.step(DT)
    np.testing.assert_allclose(parked.ego_state().xy, [2.0, -52.0])
    speeds = []
    for action in (0, 2):
        agent = traffic(
            0,
            traffic={"environment": "intersection-v0", "vehicles": 4, "warm_up": 0.0},
            ego={"control": "agent", "start": 60.0},
        )
        for _ in range(8):
            agent.act(action)
            for _ in range(2):
                agent.step(DT)
        speeds.append(float(np.hypot(*agent.ego_state().velocity)))
    assert speeds[0] < 6 < speeds[1]


def test_action_spaces() -> None:
    assert action_space(scenario()) == Discrete(1)
    agent = {"control": "agent"}
    assert isinstance(action_space(scenario(ego=agent)), Box)
    assert action_space(scenario(ego=agent, traffic={"environment": "intersection-v0"})) == Discrete(3)
    with pytest.raises(ScenarioError, match="needs traffic"):
        action_space(scenario(ego=agent, traffic={"environment": None}))


@pytest.mark.parametrize("name", ["highway-v0", "roundabout-v0", "racetrack-v0", "merge-v0", None])
def test_other_roads_carry_traffic_too(name: str | None) -> None:
    made = traffic(1, traffic={"environment": name, "vehicles": 6, "warm_up": 0.0}, ego={})
    start = made.ego_state().xy
    rows(made, 10)
    assert np.hypot(*(made.ego_state().xy - start)) > 3
    assert len(made.states()) >= 3
    assert len(made.roads) >= 2


def test_rough_crossing_roads_are_the_crossings() -> None:
    made = Traffic(load("rough-crossing"), np.random.SeedSequence(0))
    lines = np.concatenate([road.centerline for road in made.roads])
    on_arms = np.abs(lines).min(1) < 2.01
    assert on_arms.mean() > 0.9
    assert np.abs(lines).max() > 250
