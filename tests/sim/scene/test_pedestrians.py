from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from datmo.errors import ScenarioError
from datmo.messages import Kind
from scenarios.spec import Pedestrian
from sim.scene.autopilot import Claim, RightOfWay
from sim.scene.pedestrians import Crowd
from sim.scene.roads import Road
from sim.scene.vehicles import Body, State
from sim.scene.walkers.boxes import Boxes
from sim.scene.walkers.line import on_road
from sim.scene.walkers.party import PATIENCE

LANE = np.stack([np.linspace(-50, 50, 201), np.zeros(201)], -1)
ROADS = [Road(LANE + np.array([0, y]), 4.0) for y in (2, -2)]
DT = 0.05
CAR = Body("car/0", Kind.CAR, 4.0, 1.8)


def walk(**more: object) -> Pedestrian:
    return Pedestrian.model_validate({"start": (0.0, -6.0), "goal": (0.0, 6.0), "speed": 1.4, **more})


def crowd(*walks: Pedestrian, seed: int = 0, roads: list[Road] = ROADS) -> Crowd:
    seeds = [np.random.SeedSequence(seed, spawn_key=(i,)) for i in range(len(walks))]
    return Crowd(walks, roads, seeds, 0.0)


def car(x: float, y: float, v: tuple[float, float] = (0.0, 0.0), name: int = 0) -> State:
    return State(name, CAR, np.array([x, y]), float(np.arctan2(v[1], v[0])) if any(v) else 0.0, np.array(v))


def play(
    people: Crowd, seconds: float, way: RightOfWay | None = None, others: tuple[State, ...] = ()
) -> np.ndarray:
    """(steps, people, 5): x, y, velocity, yaw."""
    rows = []
    way = way or RightOfWay()
    for _ in range(round(seconds / DT)):
        people.step(DT, way, others)
        rows.append([(*s.xy, *s.velocity, s.yaw) for s in people.states()])
    return np.array(rows)


def overlap(people: Crowd) -> float:
    """Deepest overlap [m] of the circles of shoulder width around any two."""
    x = np.array([one.xy for one in people.walkers])
    r = np.array([one.body.width / 2 for one in people.walkers])
    apart = np.hypot(*(x[:, None] - x[None]).transpose(2, 0, 1)) - r[:, None] - r[None]
    return float(-(apart[np.triu_indices(len(x), 1)]).min())


def car_on_the_road() -> Claim:
    return Claim(np.array([[0.0, 2.0]]), 1.0)


def test_the_road_has_a_kerb() -> None:
    points = np.array([[0, 0], [0, 4.2], [0, 4.5], [60, 0.0]])
    assert on_road(points, ROADS).tolist() == [True, True, False, False]


def test_it_crosses_and_comes_back() -> None:
    rows = play(crowd(walk()), 25.0)[:, 0]
    assert rows[:, 1].max() == pytest.approx(6.0, abs=0.06)
    assert rows[-1, 1] < 0
    moved = np.diff(rows[:, :2], axis=0) / DT
    assert np.hypot(*moved.T).max() <= 1.3 * 1.4
    np.testing.assert_allclose(moved, (rows[1:, 2:4] + rows[:-1, 2:4]) / 2, atol=1e-9)
    assert np.abs(np.diff(rows[:, 4])).max() <= 3.0 * DT + 1e-9


def test_it_waits_at_the_kerb_while_a_vehicle_is_there_then_goes() -> None:
    people, way = crowd(walk()), RightOfWay()
    way.brake[1001] = way.held[1001] = car_on_the_road()
    waiting = play(people, PATIENCE + 8, way)[:, 0]
    assert -4.8 < waiting[-1, 1] < -4.55
    assert np.abs(waiting[-1, 2:4]).max() < 0.01
    way.keep([101])
    assert play(people, 8.0, way)[-1, 0, 1] > 4.0


@pytest.mark.parametrize(("behaviour", "patience"), [("crossing", PATIENCE), ("jaywalking", 0.0)])
def test_patience_with_those_who_could_stop_ends_and_jaywalkers_have_none(
    behaviour: str, patience: float
) -> None:
    people, way = crowd(walk(behaviour=behaviour)), RightOfWay()
    way.ahead[1001] = car_on_the_road()
    y = play(people, 10.0, way)[:, 0, 1]
    begun = DT * np.flatnonzero(y > -4.5)[0]
    alone = DT * np.flatnonzero(play(crowd(walk()), 10.0)[:, 0, 1] > -4.5)[0]
    assert begun - alone == pytest.approx(patience, abs=patience / 2 + 0.1)


def test_on_the_road_it_claims_the_rest_of_it() -> None:
    people, way = crowd(walk()), RightOfWay()
    while people.walkers[0].xy[1] < 0:
        people.step(DT, way)
    claim = way.held[101]
    assert claim.walker
    assert claim.points[:, 1].min() == pytest.approx(0.0, abs=0.1)
    assert claim.points[:, 1].max() >= 4.0


def test_it_begins_in_time_and_waiting_ones_stay() -> None:
    assert np.ptp(play(crowd(walk(begin=3.0)), 2.9)[..., 1]) == 0
    assert np.ptp(play(crowd(walk(behaviour="waiting")), 20.0)[..., 1]) == 0


def test_its_gait_follows_the_way_walked() -> None:
    people, way = crowd(walk()), RightOfWay()
    assert people.states()[0].body.asset.count("/") == 1
    seen = []
    for _ in range(200):
        people.step(DT, way)
        seen.append((people.walkers[0].cycle, people.states()[0].body.asset))
    phases = [int(a.split("/")[-1]) for _, a in seen if a.count("/") == 2]
    assert not any("run" in a for _, a in seen)
    turns = sum((b - a) % 16 for a, b in pairwise(phases)) / 16
    assert turns == pytest.approx(seen[-1][0] - seen[0][0], abs=0.15)
    assert set(phases) == set(range(16))


@pytest.mark.parametrize(
    "block", [0, *(pytest.param(block, marks=pytest.mark.long) for block in range(1, 5))]
)
def test_two_who_meet_head_on_pass(block: int) -> None:
    for seed in range(10 * block, 10 * block + 10):
        walks = [walk(start=(0, -6), goal=(0, 6)), walk(start=(0, 6), goal=(0, -6))]
        people = crowd(*walks, seed=seed, roads=[])
        deepest = -9.0
        rows = []
        for _ in range(280):
            people.step(DT, RightOfWay())
            deepest = max(deepest, overlap(people))
            rows.append([one.xy[1] for one in people.walkers])
        assert deepest <= 0.0
        assert np.max(rows, 0)[0] > 5.9
        assert np.min(rows, 0)[1] < -5.9


def test_a_parked_car_is_walked_around() -> None:
    for seed in range(10):
        people = crowd(walk(start=(0, -8), goal=(0, 8)), seed=seed, roads=[])
        rows = play(people, 16.0, others=(car(0.4, 0.0),))[:, 0]
        gap = np.maximum(np.abs(rows[:, :2] - [0.4, 0.0]) - [2.0, 0.9], 0)
        assert np.hypot(*gap.T).min() > 0.35
        assert rows[:, 1].max() > 7.9
        assert np.hypot(*np.diff(rows[:240, :2], axis=0).T).sum() < 22


def test_a_group_goes_round_a_wall() -> None:
    wall = Boxes(np.array([[0.5, 0.0]]), np.array([[4.0, 0.15]]), np.zeros(1), np.zeros((1, 2)))
    people = crowd(walk(start=(2, -5), goal=(2, 5), group=3), roads=[])
    for _ in range(300):
        people.step(DT, RightOfWay(), (), wall)
    assert min(one.xy[1] for one in people.walkers) > 1 or people.parties[0].way < 0


def test_people_leave_the_way_of_a_scripted_car() -> None:
    people, way = (
        crowd(walk(start=(0, 0.3), goal=(9, 0.3)), walk(behaviour="waiting"), roads=[]),
        RightOfWay(),
    )
    people.walkers[1].xy = people.walkers[1].home = np.array([12.0, 20.0])
    for k in range(200):
        x = -40 + 6 * DT * k
        way.place(1, Claim(np.stack([x + np.arange(-2, 26, 0.5), np.zeros(56)], -1), 0.9))
        people.step(DT, way, [car(-99, 0), car(x, 0.0, (6.0, 0.0), name=1)])
        gap = np.maximum(np.abs(people.walkers[0].xy - [x, 0.0]) - [2.0, 0.9], 0)
        assert np.hypot(*gap) > 0.3
    assert people.walkers[1].speed == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    "size", [pytest.param(2, marks=pytest.mark.long), 3, pytest.param(5, marks=pytest.mark.long)]
)
def test_a_group_stays_together_and_crosses_as_one(size: int) -> None:
    for seed in range(4):
        people = crowd(walk(group=size, start=(0, -9), goal=(0, 9)), seed=seed)
        way = RightOfWay()
        way.brake[1001] = car_on_the_road()
        rows = np.concatenate([play(people, 8.0, way), play(people, 20.0)])
        centre = rows[:, :, :2].mean(1, keepdims=True)
        assert np.hypot(*(rows[:, :, :2] - centre).transpose(2, 0, 1)).max() < 3.0
        assert rows[:160, :, 1].max() < -4.3
        assert rows[:, :, 1].max(0).min() > 8.5
        assert len({one.name for one in people.walkers}) == size


def test_stop_and_go_really_stops_and_goes() -> None:
    v = np.hypot(
        *play(crowd(walk(behaviour="stop-and-go", start=(0, 10), goal=(0, 70)), seed=1), 40)[:, 0, 2:4].T
    )
    flips = np.flatnonzero(np.diff((v > 0.05).astype(int)))
    assert len(flips) >= 6
    assert (v < 0.05).mean() > 0.1
    assert (v > 1.2).mean() > 0.3


def test_who_runs_out_starts_at_the_trigger_runs_and_stays() -> None:
    runner = walk(behaviour="running-out", trigger={"distance": 15.0}, speed=3.2)
    people, way = crowd(runner), RightOfWay()
    started, top = None, 0.0
    for k in range(200):
        x = -40 + 8 * DT * k
        people.step(DT, way, [car(x, -12.0, (8.0, 0.0))])
        one = people.walkers[0]
        if started is None and one.speed > 0.05:
            started = float(np.hypot(x - one.xy[0], 12.0 + one.xy[1]))
        top = max(top, one.speed)
        assert ("run" in people.states()[0].body.asset) == (one.speed > 2.2)
    assert started == pytest.approx(15.0, abs=8 * DT + 0.05)
    assert top > 2.5
    assert people.walkers[0].xy[1] == pytest.approx(6.0, abs=0.1)
    assert play(people, 10.0)[-1, 0, 1] == pytest.approx(6.0, abs=0.1)
    assert runner.runs


def test_adding_a_pedestrian_changes_nobody_elses_luck() -> None:
    alone = crowd(walk(group=2), walk(start=(20, -6), goal=(20, 6)))
    more = crowd(walk(group=2), walk(start=(20, -6), goal=(20, 6)), walk(start=(40, -6), goal=(40, 6)))
    for a, b in zip(alone.walkers, more.walkers, strict=False):
        assert (a.name, a.pace, a.aside, a.cycle, a.body) == (b.name, b.pace, b.aside, b.cycle, b.body)
    first = crowd(walk()).walkers[0]
    both = crowd(walk(group=3)).walkers[0]
    assert (first.pace, first.cycle, first.body) == (both.pace, both.cycle, both.body)
    assert (
        play(alone, 5.0).tobytes()
        == play(crowd(walk(group=2), walk(start=(20, -6), goal=(20, 6))), 5.0).tobytes()
    )


def test_children_are_small_and_adults_are_not() -> None:
    from sim.scene.assets import asset

    for seed in range(8):
        small, large = crowd(walk(age="child"), walk(age="adult"), seed=seed).walkers
        assert asset(small.body.asset).size[2] < 1.5 < asset(large.body.asset).size[2]


def test_there_are_ids_for_so_many_only() -> None:
    with pytest.raises(ScenarioError, match="1200 people"):
        crowd(*[walk(group=12)] * 100)
