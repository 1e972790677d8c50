from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.geometry import corners_bev, overlap_bev
from sim.scene.autopilot import GAP, HARD, STEP, Claim, Mover, RightOfWay, room, stretch

DT = 0.05
LENGTH, WIDTH = 4.0, 2.0


class Car:
    """A point on a straight line, for tests: no steering, exact speed."""

    def __init__(self, name: int, start: float, speed: float, heading: float, first: bool = False) -> None:
        self.name, self.s, self.speed, self.before, self.first = name, start, speed, 0.0, first
        self.cruise = 8.0
        self.direction = np.array([np.cos(heading), np.sin(heading)])
        self.heading = heading

    def mover(self) -> Mover:
        """The lines all cross at the origin: stop line 8 m before it, free 4 m behind it."""
        rear = self.s - LENGTH / 2
        i = np.floor(rear / STEP)
        path = (np.arange(160) + i)[:, None] * STEP * self.direction
        wish = min(2.0, self.cruise - self.speed)
        zone = (-8.0 - rear, 4.0 - rear, self.name) if rear < 4 else None
        return Mover(self.name, path, LENGTH, WIDTH, self.speed, wish, self.before, zone, self.first)

    def step(self, a: float) -> None:
        self.before = a
        self.s += self.speed * DT + a * DT**2 / 2
        self.speed = max(self.speed + a * DT, 0.0)


def boxes(cars: list[Car]) -> np.ndarray:
    centre = np.array([c.s * c.direction for c in cars])
    size = np.tile([LENGTH, WIDTH], (len(cars), 1))
    return corners_bev(centre, size, np.array([c.heading for c in cars]))


def play(cars: list[Car], way: RightOfWay, seconds: float) -> list[float]:
    used = []
    for _ in range(round(seconds / DT)):
        chosen = way.decide([c.mover() for c in cars], DT)
        for car in cars:
            car.step(chosen[car.name])
            used.append(chosen[car.name])
        corners = boxes(cars)
        for i in range(len(cars)):
            for j in range(i):
                assert overlap_bev(corners[i], corners[j]) == 0, (i, j)
    return used


def test_room_ends_where_somebody_stands() -> None:
    mover = Car(1, -20.0, 8.0, 0.0).mover()
    wall = Claim(np.array([[0.0, 0.0]]), 0.5)
    assert room(mover, []) > 50
    slack = 0.25 + 2 * STEP
    assert 17.5 - slack <= room(mover, [wall]) <= 17.5
    assert room(mover, [Claim(np.array([[0.0, 3.0]]), 0.5)]) > 50
    assert room(mover, [Claim(np.array([[-18.5, 0.0]]), 0.5)]) == 0


def test_a_stretch_covers_the_body() -> None:
    mover = Car(1, 0.0, 0.0, 0.0).mover()
    claim = stretch(mover, 0.0, LENGTH)
    assert claim.radius > WIDTH / 2
    assert claim.points[:, 0].min() == pytest.approx(-1.0, abs=STEP)
    assert claim.points[:, 0].max() == pytest.approx(1.0, abs=STEP)


def test_it_stops_at_ease_before_what_stands() -> None:
    car, way = Car(1, -80.0, 8.0, 0.0), RightOfWay()
    way.place(9, Claim(np.array([[-20.0, 0.0]]), 0.5))
    used = play([car], way, 20.0)
    gap = -20.5 - (car.s + LENGTH / 2)
    assert 0.3 * GAP < gap < GAP + 1.5
    assert car.speed < 0.05
    assert min(used) > -3.5


def test_it_stops_hard_for_who_steps_out_late() -> None:
    car, way = Car(1, -18.0, 8.0, 0.0), RightOfWay()
    play([car], way, 0.2)
    way.place(101, Claim(np.array([[-5.0, 0.0]]), 0.4, walker=True))
    used = play([car], way, 4.0)
    assert car.speed < 0.05
    assert car.s + LENGTH / 2 < -5.4
    assert min(used) >= -HARD


def test_the_first_goes_before_an_earlier_one_that_can_still_stop() -> None:
    ego, other, way = Car(0, -33.0, 8.0, 0.0, first=True), Car(1, -31.0, 8.0, np.pi / 2), RightOfWay()
    play([other, ego], way, 3.0)
    assert ego.speed == pytest.approx(8.0, abs=0.3)
    assert other.speed < 6.0
    play([other, ego], way, 9.0)
    assert min(ego.s, other.s) > 4


@pytest.mark.long
@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.tuples(st.floats(-90, -16), st.floats(0, 9)), min_size=2, max_size=5),
    st.integers(0, 10),
)
def test_nobody_drives_into_anybody_and_everybody_gets_through(
    starts: list[tuple[float, float]], turn: int
) -> None:
    """Cars on different lines through one crossing; those that could not stop at the start are slowed."""
    cars = []
    for i, (s, v) in enumerate(starts):
        able = np.sqrt(2 * 3.0 * max(-s - LENGTH / 2 - 9.0, 0.0))
        cars.append(Car(i + 1, s, min(v, able), turn / 10 + i * 2 * np.pi / 5))
    used = play(cars, RightOfWay(), 8.0 * len(cars) + 14.0)
    assert min(used) >= -HARD
    assert all(car.s > 4 for car in cars)


def test_those_who_left_are_forgotten() -> None:
    way = RightOfWay()
    play([Car(1, -30.0, 8.0, 0.0)], way, 2.5)
    assert 1 in way.held
    assert 1 in way.crossing
    way.keep([])
    assert [way.held, way.brake, way.ahead, way.crossing] == [{}] * 4


def test_walkers_wait_for_who_is_near_and_new_vehicles_for_all() -> None:
    way = RightOfWay()
    play([Car(1, -60.0, 8.0, 0.0)], way, 0.1)
    near, far = (Claim(np.array([[x, 0.0]]), 0.4) for x in (-52.0, -43.0))
    assert not way.may_step(near, at_ease=False)
    assert way.may_step(far, at_ease=False)
    assert not way.may_step(far, at_ease=True)
    assert not way.free(far)
    assert way.free(Claim(np.array([[-60.0, 5.0]]), 1.0))
