from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from datmo.arrays import F64
from datmo.errors import ScenarioError, SimulationError
from datmo.geometry import inverse, transform
from datmo.messages import Kind
from scenarios import spec
from sim.scan.bodies import Body
from sim.scan.pattern import pattern
from sim.scan.sweep import Lidar, mount
from sim.scan.units import unit
from sim.scene.motion import Poses
from sim.scene.roads import Road
from sim.scene.terrain import Terrain, build_terrain

Bodies = Callable[[str], Body]
NAME = "hdl64e-s3-20171102"
SEED = np.random.SeedSequence(5)
QUIET = spec.IDEAL.model_dump()


@pytest.fixture(scope="module")
def hills() -> Terrain:
    rough = spec.Terrain(grade=0.06, cross_slope=0.03, roughness="E", road_roughness="B", cell=0.8)
    road = Road(np.array([[0.0, -90.0], [0.0, 90.0]]), 8.0)
    return build_terrain(rough, [road], (-90, -90, 90, 90), np.random.SeedSequence(2))


@pytest.fixture(scope="module")
def drive(kit: SimpleNamespace, hills: Terrain) -> Poses:
    """A fast, turning, pitching ego among a car and a walker, at 20 Hz."""
    grid = pattern(unit(NAME), 20)
    feet = hills.height_at(np.array([[6.0, 9.0], [-5.0, 0.0]]))

    def ego(t: float) -> F64:
        return np.asarray(kit.at(1, 15 * t, 0.1, 1.57 + 0.8 * t, 0.05 + 0.4 * t))

    def car(t: float) -> F64:
        return np.asarray(kit.at(6 + 10 * t, 9, feet[0], 0.3, 0.05))

    def walker(t: float) -> F64:
        return np.asarray(kit.at(-5, 1.4 * t, feet[1], 1.57))

    return kit.poses_of(grid, ego, [("car", car), ("ped", walker)])  # type: ignore[no-any-return]


def lidar(terrain: Terrain, bodies: Bodies, noise: dict[str, Any] | None = None, **more: Any) -> Lidar:
    sensor = spec.Sensor(noise=spec.Noise(**(QUIET if noise is None else noise)), **more)
    return Lidar(sensor, 20.0, terrain, (), SEED, bodies)


def test_deskewed_points_lie_where_the_world_is(hills: Terrain, bodies: Bodies, drive: Poses) -> None:
    """Without noise every ground return lies on the terrain, every walker.s on its box: checks all frames."""
    scan, truth = lidar(hills, bodies).sweep(drive, 3)
    assert truth.is_ground.sum() > 20000
    np.testing.assert_allclose(scan.points[truth.is_ground, 2], truth.height[truth.is_ground], atol=2e-3)
    world = transform(scan.T_world_sensor, scan.points)
    np.testing.assert_allclose(
        world[truth.is_ground, 2], hills.height_at(world[truth.is_ground, :2]), atol=2e-3
    )
    walker = truth.actor == 1
    local = transform(inverse(truth.T_world_actor[1]), world[walker])
    assert walker.sum() > 100
    assert (np.abs(local) < np.array([0.2 + 0.1, 0.25 + 0.01, 1.76])).all()  # it walked up to 0.07 m


def test_points_not_deskewed_are_those_of_the_head(hills: Terrain, bodies: Bodies, drive: Poses) -> None:
    one = lidar(hills, bodies, deskew="none")
    scan, truth = one.sweep(drive, 3)
    still, _ = lidar(hills, bodies).sweep(drive, 3)
    distance, _ = one.range_image()
    ring, column = np.nonzero(distance)
    want = (
        one.pattern.origins[ring, column]
        + distance[ring, column, None] * one.pattern.directions[ring, column]
    )
    np.testing.assert_allclose(scan.points, want, atol=1e-4)
    assert not scan.deskewed
    assert still.deskewed
    assert np.abs(still.points - scan.points).max() > 0.3
    assert len(truth.actor) == len(scan)


def test_rows_run_ring_by_ring_in_firing_order(hills: Terrain, bodies: Bodies, drive: Poses) -> None:
    scan, truth = lidar(hills, bodies, {"range_std": 0.01}).sweep(drive, 3)
    step = np.diff(scan.ring.astype(int))
    assert (step >= 0).all()
    assert (np.diff(scan.dt)[step == 0] > 0).all()
    assert scan.stamp == truth.stamp == pytest.approx(0.15)
    assert (scan.dt <= 0).all()
    assert scan.dt.min() >= -0.05
    np.testing.assert_allclose(scan.T_world_sensor, drive.T_world_ego[-1] @ mount(spec.Sensor()), atol=1e-12)
    bare = {"actor": len(scan), "thing": len(scan), "normal": len(scan), "height": len(scan)}
    assert {name: len(getattr(truth, name)) for name in bare} == bare


def test_every_ray_is_accounted_for(hills: Terrain, bodies: Bodies, drive: Poses) -> None:
    one = lidar(hills, bodies, {"edges": False, "multipath": False})
    scan, truth = one.sweep(drive, 0)
    assert len(scan) + len(truth.lost.ring) == 64 * one.pattern.columns
    distance, intensity = one.range_image()
    assert distance.shape == intensity.shape == (64, one.pattern.columns)
    assert not distance[truth.lost.ring, truth.lost.column].any()
    np.testing.assert_array_equal(truth.solo, truth.visible + truth.lost_to.sum(1))
    np.testing.assert_array_equal(truth.returns, np.bincount(truth.actor[truth.actor >= 0], minlength=2))
    assert (truth.returns <= truth.visible).all()
    dropped = np.bincount(truth.lost.actor[truth.lost.actor >= 0], minlength=2)
    np.testing.assert_array_equal(truth.visible, truth.returns + dropped)
    assert set(np.unique(truth.kind)) == {Kind.CAR, Kind.PEDESTRIAN, Kind.ROAD, Kind.FIELD}
    np.testing.assert_array_equal(truth.boxes.id, [10, 11])
    np.testing.assert_allclose(truth.boxes.yaw, [0.3, 1.57], atol=1e-9)
    np.testing.assert_allclose(truth.boxes.size[0], [4.5, 1.8, 1.5])
    assert np.linalg.norm(truth.boxes.velocity[0]) == pytest.approx(10)
    foot = truth.T_world_actor[0] @ [0, 0, 0.75, 1]
    np.testing.assert_allclose(truth.boxes.center[0], foot[:3], atol=1e-9)


def test_noise_of_a_frame_does_not_depend_on_its_history(
    hills: Terrain, bodies: Bodies, drive: Poses
) -> None:
    first, second = lidar(hills, bodies, {}), lidar(hills, bodies, {})
    first.sweep(drive, 0)
    first.sweep(drive, 1)
    a, b = first.sweep(drive, 7), second.sweep(drive, 7)
    assert a[0] == b[0]
    assert a[1] == b[1]
    assert a[0] != second.sweep(drive, 8)[0]


def test_noise_is_as_large_as_asked(hills: Terrain, bodies: Bodies, drive: Poses) -> None:
    ideal, noisy = lidar(hills, bodies), lidar(hills, bodies, {**QUIET, "range_std": 0.02, "drop_out": 0.1})
    ideal.sweep(drive, 0)
    noisy.sweep(drive, 0)
    true, got = ideal.range_image()[0], noisy.range_image()[0]
    both = (true > 0) & (got > 0)
    assert both.sum() / (true > 0).sum() == pytest.approx(0.9, abs=0.01)
    error, bright = (got - true)[both], (true[both] < 4)
    assert 0.0195 < error[bright].std() < 0.0225  # where it is dark, light is short
    assert 0.02 < error[~bright].std() < 0.04
    assert abs(error.mean()) < 5e-4
    gone = (true > 0) & (got == 0)
    pairs = (gone[:, 1:] & gone[:, :-1]).sum() / gone.sum()
    assert pairs < 0.15  # isolated: neighbours go together no more often than by chance


def test_intensity_is_in_steps_and_by_class(hills: Terrain, bodies: Bodies, drive: Poses) -> None:
    scan, truth = lidar(hills, bodies, {}).sweep(drive, 0)
    np.testing.assert_allclose(scan.intensity * 100, np.round(scan.intensity * 100), atol=1e-4)
    assert ((scan.intensity >= 0) & (scan.intensity <= 1)).all()
    mean = {kind: scan.intensity[truth.kind == kind].mean() for kind in (Kind.ROAD, Kind.FIELD, Kind.CAR)}
    assert mean[Kind.ROAD] == pytest.approx(0.2, abs=0.03)
    assert mean[Kind.FIELD] == pytest.approx(0.33, abs=0.04)
    assert mean[Kind.CAR] < 0.35  # the kit's box is bright for paint
    assert 0.02 < (scan.intensity == 0).mean() < 0.15


def test_asphalt_is_seen_to_fifty_or_sixty_metres(kit: SimpleNamespace, bodies: Bodies) -> None:
    flat = build_terrain(
        spec.Terrain(cell=2.0), [Road(np.array([[0, -90.0], [0, 90]]), 200.0)], (-90, -90, 90, 90), SEED
    )
    poses = kit.poses_of(pattern(unit(NAME), 20), lambda _: np.eye(4), [])
    one = lidar(flat, bodies, {"drop_out": 0.0})
    scan, truth = one.sweep(poses, 0)
    reach = np.linalg.norm(scan.points[truth.is_ground], axis=1)
    met = np.concatenate([reach, truth.lost.range[np.isfinite(truth.lost.range)]])
    share = {
        r: np.histogram(reach, [r - 5, r + 5])[0][0] / np.histogram(met, [r - 5, r + 5])[0][0]
        for r in (20, 40, 55, 75)
    }
    assert share[20] > 0.99
    assert share[40] > 0.8
    assert 0.2 < share[55] < 0.8
    assert share[75] < 0.15


def test_own_body_counts_in_neither(kit: SimpleNamespace, hills: Terrain, bodies: Bodies) -> None:
    poses = kit.poses_of(
        pattern(unit(NAME), 20), lambda _: np.eye(4), [("ped", lambda _: kit.at(-4.0, 0.0, 0.0, 0.0))]
    )
    masked, open_ = (lidar(hills, bodies, body_mask=mask) for mask in (True, False))
    a, b = masked.sweep(poses, 0)[1], open_.sweep(poses, 0)[1]
    assert 0 < a.solo[0] < b.solo[0]
    assert a.visible[0] < b.visible[0]


def test_nothing_nearer_than_the_least_range(kit: SimpleNamespace, hills: Terrain, bodies: Bodies) -> None:
    """A car right before the sensor returns nothing, is not seen, and still hides what is behind it."""
    grid = pattern(unit(NAME), 20)
    near, far = ("car", lambda _: kit.at(2.9, 0, 0.5, 0)), ("ped", lambda _: kit.at(7, 0, 0.4, 0))
    scan, truth = lidar(hills, bodies).sweep(kit.poses_of(grid, lambda _: np.eye(4), [near, far]), 0)
    assert np.linalg.norm(scan.points, axis=1).min() > 0.85
    assert truth.lost_to[1, 0] > 0
    close = truth.lost.range < 0.9
    assert (truth.lost.actor[close] == 0).all()
    assert close.any()


def test_things_stand_on_the_ground_and_are_known(
    kit: SimpleNamespace, hills: Terrain, bodies: Bodies
) -> None:
    things = (
        spec.Thing(kind="pole", at=(5, 3), size=(0.3, 0.3, 1.5)),
        spec.Thing(kind="wall", at=(-8, 0), size=(10, 0.3, 2), yaw_deg=90),
    )
    sensor = spec.Sensor(noise=spec.Noise(**QUIET))
    one = Lidar(sensor, 20.0, hills, things, SEED, bodies)
    poses = kit.poses_of(pattern(unit(NAME), 20), lambda _: kit.at(0, 0, 0.1, 0), [])
    scan, truth = one.sweep(poses, 0)
    world = transform(scan.T_world_sensor, scan.points)
    for i, kind, reach in ((0, Kind.POLE, 0.16), (1, Kind.WALL, 0.16)):
        mine = truth.thing == i
        assert mine.sum() > 50
        assert (truth.kind[mine] == kind).all()
        assert (np.abs(world[mine, 0] - things[i].at[0]) <= reach).all()
        above = world[mine, 2] - hills.height_at(world[mine, :2])
        assert -0.05 < above.min() < 0.3
        assert things[i].size[2] - 0.5 < above.max() < things[i].size[2] + 0.2
    assert not truth.is_ground[truth.thing >= 0].any()


def test_bad_input_is_refused(hills: Terrain, bodies: Bodies) -> None:
    with pytest.raises(ScenarioError, match="no unit"):
        lidar(hills, bodies, unit="hdl-23e")
    with pytest.raises(SimulationError, match="sweep"):
        lidar(hills, bodies).range_image()


def test_pitch_turns_the_nose_down() -> None:
    ahead = mount(spec.Sensor(pitch_deg=10, forward=0.5)) @ [10, 0, 0, 1]
    assert ahead[2] < 1.73 - 1.7
    assert ahead[0] == pytest.approx(0.5 + 10 * np.cos(np.deg2rad(10)))
