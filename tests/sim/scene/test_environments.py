"""Every environment that highway-env registers plays as traffic, whatever its version lists."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from scenarios.spec import Scenario
from sim.scene.course import onward
from sim.scene.flow import Traffic
from sim.scene.motion import Poses
from sim.scene.traffic import EXTEND
from sim.scene.world import World

IDS = sorted(name for name, made in gym.registry.items() if "highway_env." in str(made.entry_point))
NEWEST = {name.rpartition("-v")[0]: name for name in IDS}
FEW = [NEWEST[kind] for kind in ("highway", "intersection", "merge", "parking", "racetrack", "roundabout")]
GIVEN = [name if name in FEW else pytest.param(name, marks=pytest.mark.long) for name in IDS]
SWEEPS = 8


def scenario(name: str, control: str = "autopilot", **more: Any) -> Scenario:
    return Scenario.model_validate(
        {
            "name": "t",
            "duration": 1.0,
            "terrain": {"cell": 2.0, "grade": 0.05},
            "traffic": {"environment": name, "vehicles": 4, "warm_up": 0.5},
            "sensor": {"range": 30.0},
            "ego": {"control": control, **more},
        }
    )


def play(world: World, actions: list[Any]) -> list[Poses]:
    return [world.reset(), *(world.advance(action) for action in actions)]


def test_the_registry_is_not_empty() -> None:
    assert len(IDS) >= 20


@pytest.mark.parametrize("name", GIVEN)
def test_every_environment_plays_on_autopilot(name: str) -> None:
    world = World(scenario(name), np.random.SeedSequence(3))
    played = play(world, [None] * SWEEPS)
    ego = np.array([p.T_world_ego[-1] for p in played])
    assert np.linalg.norm(ego[-1, :2, 3] - ego[0, :2, 3]) > 3
    assert not world.crashed
    assert not world.arrived
    assert any(len(p) for p in played)
    for p in played:
        assert np.isfinite(p.T_world_actor).all()
        assert len(set(p.id.tolist())) == len(p)
    ground = world.terrain.height_at(ego[:, :2, 3])
    assert np.abs(ego[:, 2, 3] - ground).max() < 0.05
    again = play(World(scenario(name), np.random.SeedSequence(3)), [None] * 2)
    assert [p.T_world_actor.tobytes() for p in again] == [p.T_world_actor.tobytes() for p in played[:3]]


@pytest.mark.parametrize("name", GIVEN)
def test_every_environment_obeys_an_agent(name: str) -> None:
    asked = scenario(name, "agent")
    space = World.actions(asked)
    space.seed(1)
    played = play(World(asked, np.random.SeedSequence(3)), [space.sample() for _ in range(3)])
    assert all(np.isfinite(p.T_world_ego).all() for p in played)
    assert np.linalg.norm(played[-1].T_world_ego[-1, :2, 3] - played[0].T_world_ego[-1, :2, 3]) > 0.3


@pytest.mark.parametrize("name", [name for name in IDS if "roundabout" in name])
def test_the_arms_of_a_roundabout_lead_into_its_ring(name: str) -> None:
    made = Traffic(scenario(name), np.random.SeedSequence(1))
    ring = {"se", "ex", "ee", "nx", "ne", "wx", "we", "sx"}
    assert len(set(made.ego.course.keys[2]) & ring) == 2
    for key, lane in made._highway.lanes.items():
        assert not (lane.leaving and key[1] in ring), key


@pytest.mark.parametrize("name", [name for name in IDS if "roundabout" in name])
def test_the_ego_goes_half_round_and_leaves_on_the_road(name: str) -> None:
    made = Traffic(scenario(name), np.random.SeedSequence(1))
    lanes = np.concatenate([lane.line for lane in made._highway.lanes.values()])
    way, off = [], []
    for _ in range(600):
        made.step(0.05)
        way.append(made.ego_state().xy)
        off.append(np.hypot(*(lanes - way[-1]).T).min())
    assert made.ego.course.keys[-1] == ("nxs", "nxr", 0)
    angle = np.unwrap(np.arctan2(*np.array(way).T[::-1]))
    assert np.rad2deg(angle.max() - angle.min()) > 150
    assert max(off) < 2.0
    assert way[-1][1] > 40


@pytest.mark.parametrize("name", [name for name in IDS if "exit" in name])
def test_only_the_lane_beside_it_leads_to_an_exit(name: str) -> None:
    lanes = Traffic(scenario(name), np.random.SeedSequence(1))._highway.lanes
    leads = [lane.key for lane in lanes.values() if any(b.key[1] == "exit" for b in onward(lanes, lane))]
    assert leads == [max(key for key in lanes if key[:2] == ("1", "2"))]


@pytest.mark.long
def test_facing_rows_of_parking_do_not_run_into_each_other() -> None:
    lanes = Traffic(scenario("parking-v0"), np.random.SeedSequence(1))._highway.lanes
    rows = [np.concatenate([b.line for k, b in lanes.items() if k[0] == node]) for node in ("a", "b")]
    apart = np.hypot(*(rows[0][:, None] - rows[1]).transpose(2, 0, 1))
    assert apart.min() > 10


def test_only_straight_lanes_with_nothing_ahead_are_carried_on() -> None:
    lanes = Traffic(scenario("lane-keeping-v0"), np.random.SeedSequence(0))._highway.lanes
    bent, towards_it = lanes["a", "b", 0], lanes["d", "a", 0]
    assert bent.leaving
    assert towards_it.leaving
    assert bent.added == towards_it.added == 0
    lanes = Traffic(scenario("highway-v0"), np.random.SeedSequence(0))._highway.lanes
    assert {lane.added for lane in lanes.values() if lane.leaving} == {EXTEND}
