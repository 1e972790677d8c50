from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from datmo.errors import ScenarioError
from datmo.messages import Kind
from scenarios.spec import Actor
from sim.scene.assets import asset, stride
from sim.scene.script import Script, looks_of
from sim.scene.vehicles import Body

CAR = Body("car/0", Kind.CAR, 4.0, 2.0)


def actor(*path: tuple[float, float, float], yaw: float | None = None) -> Actor:
    points = [{"t": t, "x": x, "y": y} for t, x, y in path]
    return Actor.model_validate({"name": "a", "kind": "car", "path": tuple(points), "yaw_deg": yaw})


def test_one_way_point_parks() -> None:
    script = Script(actor((0.0, 3.0, 4.0), yaw=90.0))
    times = np.array([-5.0, 0.0, 100.0])
    np.testing.assert_array_equal(script.position(times), [[3.0, 4.0]] * 3)
    np.testing.assert_allclose(script.yaw(times), np.pi / 2)
    state = script.state(7, CAR, 2.0)
    np.testing.assert_allclose(state.velocity, 0)
    assert (state.id, state.yaw_rate) == (7, 0.0)


def test_it_passes_through_its_way_points_and_goes_on() -> None:
    path = [(0.0, 0.0, 0.0), (2.0, 10.0, 1.0), (3.0, 20.0, 6.0)]
    script = Script(actor(*path))
    for t, x, y in path:
        np.testing.assert_allclose(script.position(np.array([t]))[0], [x, y], atol=1e-9)
    late = script.position(np.array([3.0, 4.0, 5.0]))
    np.testing.assert_allclose(np.diff(late, axis=0)[0], np.diff(late, axis=0)[1], atol=1e-9)


def test_the_heading_is_that_of_the_motion() -> None:
    script = Script(actor((0.0, 0.0, 0.0), (2.0, 10.0, 1.0), (4.0, 14.0, 12.0), (6.0, 5.0, 20.0)))
    times = np.linspace(0.1, 5.9, 50)
    v = script.velocity(times)
    slip = np.abs(np.exp(1j * script.yaw(times)) - np.exp(1j * np.arctan2(v[:, 1], v[:, 0])))
    assert slip.max() < 0.02
    assert np.abs(np.diff(script.yaw(times))).max() < 0.5


def test_a_repeated_way_point_is_a_stop_without_overshoot_and_keeps_the_heading() -> None:
    script = Script(actor((0.0, 0.0, 0.0), (2.0, 10.0, 0.0), (4.0, 10.0, 0.0), (6.0, 20.0, 0.0)))
    times = np.linspace(0, 6, 200)
    x = script.position(times)[:, 0]
    assert (np.diff(x) > -1e-9).all()
    standing = (times > 2) & (times < 4)
    np.testing.assert_allclose(x[standing], 10.0, atol=1e-9)
    np.testing.assert_allclose(script.yaw(times), 0.0, atol=1e-6)


def test_it_claims_the_way_of_the_next_seconds() -> None:
    script = Script(actor((0.0, 0.0, 0.0), (10.0, 50.0, 0.0)))
    points = script.claim(CAR, 1.0).points
    assert points[:, 0].min() == pytest.approx(5.0 - 2.0)
    assert points[:, 0].max() == pytest.approx(25.0 + 2.0, abs=0.5)
    parked = Script(actor((0.0, 1.0, 1.0), yaw=0.0)).claim(CAR, 0.0)
    assert np.ptp(parked.points[:, 0]) == pytest.approx(4.0, abs=0.5)


def walker(*path: tuple[float, float, float], **more: object) -> Actor:
    points = tuple({"t": t, "x": x, "y": y} for t, x, y in path)
    return Actor.model_validate({"name": "w", "kind": "pedestrian", "path": points} | more)


def test_a_scripted_person_strides_by_the_way_walked() -> None:
    one = walker((0.0, 0.0, 0.0), (10.0, 0.0, 14.0), (12.0, 0.0, 14.0))
    script, looks = Script(one), looks_of(one)
    first = script.velocity(np.array([0.0]))[0, 1]
    ways = script.walked(np.array([-1.0, 0.0, 10.0, 11.0]))
    np.testing.assert_allclose(ways, [-first, 0, 14, 14], atol=0.01)
    assert script.walked(np.array([10.0]))[0] == pytest.approx(14.0, abs=0.01)
    phases = [script.state(1, looks, t).body.asset for t in np.arange(2.0, 6.0, 0.02)]
    changes = sum(a != b for a, b in pairwise(phases))
    way = float(np.diff(script.walked(np.array([2.0, 5.98])))[0])
    assert changes == pytest.approx(16 * way / stride(0), abs=1.1)
    assert script.state(1, looks, 11.0).body.asset == "pedestrian/0"


def test_a_child_is_chosen_among_children_and_wrong_variants_are_told() -> None:
    child = looks_of(
        Actor.model_validate({"name": "c", "kind": "child", "path": ({"t": 0, "x": 0, "y": 0},)})
    )
    assert asset(child.asset).size[2] < 1.5
    with pytest.raises(ScenarioError, match="'w': variant = 99; there are"):
        looks_of(walker((0.0, 0.0, 0.0), variant=99))


def test_a_trigger_starts_the_path_when_the_ego_is_near() -> None:
    one = walker((-2.0, 5.0, 0.0), (0.0, 5.0, 4.0), trigger={"distance": 10.0})
    script, looks = Script(one), looks_of(one)
    script.watch(np.array([-20.0, 0.0]), 3.0)
    before = script.state(1, looks, 3.5)
    np.testing.assert_array_equal(before.velocity, 0)
    np.testing.assert_allclose(before.xy, [5, 0])
    assert np.ptp(script.claim(looks, 3.5).points[:, 1]) < 2
    script.watch(np.array([-4.0, 0.0]), 4.0)
    script.watch(np.array([0.0, 0.0]), 4.5)
    np.testing.assert_allclose(script.state(1, looks, 6.0).xy, [5, 4], atol=1e-9)
    assert script.state(1, looks, 5.0).yaw == pytest.approx(np.pi / 2)
    with pytest.raises(ValueError, match="two way-points"):
        walker((0.0, 5.0, 0.0), trigger={"distance": 10.0})
