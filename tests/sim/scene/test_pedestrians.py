from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from scenarios.spec import Pedestrian
from sim.scene.autopilot import Claim, RightOfWay
from sim.scene.pedestrians import PATIENCE, Walker, on_road
from sim.scene.roads import Road

LANE = np.stack([np.linspace(-50, 50, 201), np.zeros(201)], -1)
ROADS = [Road(LANE + np.array([0, y]), 4.0) for y in (2, -2)]
DT = 0.05


def walker(behaviour: str = "crossing", seed: int = 0, **more: float) -> Walker:
    walk = Pedestrian.model_validate(
        {"behaviour": behaviour, "start": (0.0, -6.0), "goal": (0.0, 6.0), "speed": 1.4, **more}
    )
    return Walker(walk, ROADS, 101, np.random.default_rng(seed))


def play(one: Walker, way: RightOfWay, seconds: float) -> np.ndarray:
    rows = []
    for _ in range(round(seconds / DT)):
        one.step(DT, way)
        s = one.state()
        rows.append((*s.xy, *s.velocity, s.yaw))
    return np.array(rows)


def car_on_the_road() -> Claim:
    return Claim(np.array([[0.0, 2.0]]), 1.0)


def test_the_road_has_a_kerb() -> None:
    assert on_road(np.array([[0, 0], [0, 4.2], [0, 4.5], [60, 0.0]]), ROADS).tolist() == [
        True,
        True,
        False,
        False,
    ]


def test_it_crosses_and_comes_back() -> None:
    rows = play(walker(), RightOfWay(), 25.0)
    assert rows[:, 1].max() == pytest.approx(6.0, abs=0.05)
    assert rows[-1, 1] < 0
    moved = np.hypot(*np.diff(rows[:, :2], axis=0).T)
    assert moved.max() <= 1.3 * 1.4 * DT
    np.testing.assert_allclose(np.diff(rows[:, :2], axis=0) / DT, rows[1:, 2:4], atol=0.1)


def test_it_waits_at_the_kerb_while_a_vehicle_is_there_then_goes() -> None:
    one, way = walker(), RightOfWay()
    way.brake[1001] = way.held[1001] = car_on_the_road()
    waiting = play(one, way, PATIENCE + 8)
    assert waiting[-1, 1] < -4.3
    assert np.abs(waiting[-1, 2:4]).max() < 0.01
    way.keep([101])
    assert play(one, way, 8.0)[-1, 1] > 4.0


def test_its_patience_with_those_who_could_stop_ends() -> None:
    one, way = walker(), RightOfWay()
    way.ahead[1001] = car_on_the_road()
    assert play(one, way, PATIENCE)[-1, 1] < -4.3
    assert play(one, way, 5.0)[-1, 1] > -2.0


def test_on_the_road_it_claims_the_rest_of_it() -> None:
    one, way = walker(), RightOfWay()
    while one.state().xy[1] < 0:
        one.step(DT, way)
    claim = way.held[101]
    assert claim.walker
    assert claim.points[:, 1].min() == pytest.approx(0.0, abs=0.1)
    assert claim.points[:, 1].max() >= 4.0


def test_it_begins_in_time_and_waiting_ones_stay() -> None:
    assert np.ptp(play(walker(begin=3.0), RightOfWay(), 2.9)[:, 1]) == 0
    assert np.ptp(play(walker("waiting"), RightOfWay(), 20.0)[:, 1]) == 0


def test_its_gait_follows_the_way_walked() -> None:
    one, way = walker(), RightOfWay()
    assert one.state().body.asset.count("/") == 1
    seen = []
    for _ in range(200):
        one.step(DT, way)
        seen.append((one.walked, one.state().body.asset))
    phases = [int(a.split("/")[2]) for _, a in seen if a.count("/") == 2]
    turns = sum((b - a) % 16 for a, b in pairwise(phases)) / 16
    assert turns == pytest.approx(seen[-1][0] / one.stride, abs=0.15)
    assert set(phases) == set(range(16))


def test_each_has_a_variety_of_its_own() -> None:
    paces = {walker(seed=i).pace for i in range(5)}
    assert len(paces) == 5
    assert walker(seed=3).pace == walker(seed=3).pace
