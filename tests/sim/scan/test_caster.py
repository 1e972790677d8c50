from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace

import numpy as np
import pytest

from datmo.arrays import F64, Bool
from datmo.errors import SimulationError
from datmo.geometry import inverse
from sim.scan import caster as casting
from sim.scan.bodies import Body
from sim.scan.caster import Caster, Hits
from sim.scan.culling import Candidates
from sim.scan.embree import Mesh
from sim.scan.merge import NOTHING, TERRAIN, THING
from sim.scan.motion import SweepMotion, sweep_motion
from sim.scan.pattern import Pattern, pattern
from sim.scan.units import unit
from sim.scene.motion import BLOCK, Poses

Bodies = Callable[[str], Body]
PLAIN = Mesh(
    np.array([[-200, -200, 0], [200, -200, 0], [200, 200, 0], [-200, 200, 0]], np.float32),
    np.array([[0, 1, 2], [0, 2, 3]], np.int32),
)
UP = np.eye(4)
UP[2, 3] = 1.73


def caster_of(grid: Pattern, bodies: Bodies, things: Mesh | None = None, blind: Bool | None = None) -> Caster:
    blind = np.zeros(grid.directions.shape[:2], bool) if blind is None else blind
    return Caster(grid, PLAIN, things, (0.9, 80.0), blind, bodies)


def crowd(kit: SimpleNamespace, grid: Pattern, seed: int) -> Poses:
    """Actors all around, some very near, some above one another, a turning and tilting ego."""
    rng = np.random.default_rng(seed)
    actors = []
    for i in range(9):
        r, a, yaw = rng.uniform(1.0, 60) if i else 1.2, rng.uniform(-np.pi, np.pi), rng.uniform(-4, 4)
        v, w, z = rng.uniform(-30, 30), rng.uniform(-2, 2), rng.uniform(-0.5, 0.5)

        def motion(
            t: float, r: float = r, a: float = a, yaw: float = yaw, v: float = v, w: float = w, z: float = z
        ) -> F64:
            x, y = r * np.cos(a) + v * t * np.cos(yaw), r * np.sin(a) + v * t * np.sin(yaw)
            return np.asarray(kit.at(x, y, z, yaw + w * t, 0.1))

        actors.append((("car", "ped", "car")[i % 3], motion))
    return kit.poses_of(grid, lambda t: kit.at(9 * t, 0.3, 0.1, 1.0 * t, 0.05 + 0.3 * t), actors)  # type: ignore[no-any-return]


def everything(
    grid: Pattern, blind: Bool, motion: SweepMotion, T_wa: F64, bodies: Sequence[Body], max_range: float
) -> Candidates:
    """Every ray there is, moved into each actor's frame at its own time: no culling at all."""
    ring, column = np.nonzero(~blind)
    first = column // BLOCK
    w = motion.weight[column][:, None, None]
    T_ws = motion.T_world_sensor[column]
    o, d = grid.origins[ring, column], grid.directions[ring, column]
    origins, directions = [], []
    for T in T_wa:
        T_at = T[first] + w * (T[first + 1] - T[first])
        turn = np.zeros((len(ring), 3, 4))
        for k in range(3):  # summed as the kernel does, so that the bytes agree
            turn[:, :, :3] += T_at[:, k, :3, None] * T_ws[:, k, None, :3]
            turn[:, :, 3] += T_at[:, k, :3] * (T_ws[:, k, 3] - T_at[:, k, 3])[:, None]
        x = turn[:, :, 0] * o[:, :1] + turn[:, :, 1] * o[:, 1:2] + turn[:, :, 2] * o[:, 2:] + turn[:, :, 3]
        v = turn[:, :, 0] * d[:, :1] + turn[:, :, 1] * d[:, 1:2] + turn[:, :, 2] * d[:, 2:]
        origins.append(x.astype(np.float32))
        directions.append(v.astype(np.float32))
    ray = np.tile((ring * grid.columns + column).astype(np.int32), len(T_wa))
    start = len(ring) * np.arange(len(T_wa) + 1, dtype=np.int32)
    return Candidates(ray, np.concatenate(origins), np.concatenate(directions), start)


@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.long) for n in range(1, 4))])
@pytest.mark.parametrize("name", ["hdl64e-s3-20171102", "hdl64e-s2.1-sztaki"])
def test_culling_loses_nothing(
    seed: int, name: str, kit: SimpleNamespace, bodies: Bodies, monkeypatch: pytest.MonkeyPatch
) -> None:
    grid = pattern(unit(name), 20)
    poses, one = crowd(kit, grid, seed), caster_of(grid, bodies)
    fast = one.cast(poses, UP)
    monkeypatch.setattr(casting, "candidates", everything)
    slow = one.cast(poses, UP)
    assert fast.solo.sum() > 500
    for field in ("distance", "winner", "triangle", "normal", "cosine", "solo", "visible", "lost_to"):
        assert getattr(fast, field).tobytes() == getattr(slow, field).tobytes(), field


def slab(o: F64, d: F64, low: F64, high: F64) -> F64:
    """Entry distances (n,) of rays into an axis-aligned box from outside, inf where they miss."""
    with np.errstate(divide="ignore"):
        a, b = (low - o) / d, (high - o) / d
    near, far = np.minimum(a, b).max(1), np.maximum(a, b).min(1)
    return np.where((near <= far) & (near > 0), near, np.inf)


def test_hits_agree_with_a_plain_reference(kit: SimpleNamespace, bodies: Bodies) -> None:
    """Each ray and actor by itself in double precision, with poses interpolated and inverted anew."""
    grid = pattern(unit("hdl64e-s3-xiesc"), 20)
    poses = crowd(kit, grid, 7)
    hits = caster_of(grid, bodies).cast(poses, UP)
    for column in range(5, grid.columns, 37):
        b, o, d = column // BLOCK, grid.origins[:, column], grid.directions[:, column]
        first, last = b * BLOCK, min((b + 1) * BLOCK, grid.columns)
        w = (column + 1 - first) / (last - first)
        T_ws = ((1 - w) * poses.T_world_ego[b] + w * poses.T_world_ego[b + 1]) @ UP
        o_w, d_w = o @ T_ws[:3, :3].T + T_ws[:3, 3], d @ T_ws[:3, :3].T
        with np.errstate(divide="ignore"):
            best = np.where(d_w[:, 2] < 0, -o_w[:, 2] / d_w[:, 2], np.inf)
        for row, name in enumerate(poses.asset):
            T_aw = np.linalg.inv((1 - w) * poses.T_world_actor[row, b] + w * poses.T_world_actor[row, b + 1])
            o_a, d_a = o_w @ T_aw[:3, :3].T + T_aw[:3, 3], d_w @ T_aw[:3, :3].T
            best = np.minimum(best, slab(o_a, d_a, bodies(name).low, bodies(name).high))
        got = hits.distance.reshape(64, -1)[:, column]
        want = np.where(best <= 80, best, np.inf)
        np.testing.assert_array_equal(np.isfinite(got), np.isfinite(want))
        np.testing.assert_allclose(got[np.isfinite(got)], want[np.isfinite(want)], rtol=1e-4, atol=1e-4)


def test_a_plate_that_comes_at_30_metres_a_second(
    kit: SimpleNamespace, bodies: Bodies, coarse: Pattern
) -> None:
    """Each ray finds the plate where it is at the ray's own time: x0 + v t, closed form."""
    speed, x0 = -30.0, 20.0
    poses = kit.poses_of(coarse, lambda _: np.eye(4), [("plate", lambda t: kit.at(x0 + speed * t, 0, 0, 0))])
    hits = caster_of(coarse, bodies).cast(poses, UP)
    ring, column = np.nonzero(hits.winner.reshape(64, -1) == 0)
    front = np.abs(hits.normal.reshape(64, -1, 3)[ring, column, 0]) > 0.9
    ring, column = ring[front], column[front]
    assert len(ring) > 500
    want = (x0 + speed * coarse.time[column] - 0.01) / coarse.directions[ring, column, 0]
    np.testing.assert_allclose(hits.distance.reshape(64, -1)[ring, column], want, atol=2e-4)


def test_a_plate_that_crosses_at_30_metres_a_second(
    kit: SimpleNamespace, bodies: Bodies, coarse: Pattern
) -> None:
    """Which rays meet it, closed form: those that pass its plane within its width at their own time."""
    speed, x0 = 30.0, 15.0
    poses = kit.poses_of(coarse, lambda _: np.eye(4), [("plate", lambda t: kit.at(x0, speed * t, 0, 0))])
    hits = caster_of(coarse, bodies).cast(poses, UP)
    d = coarse.directions
    ahead = np.where(d[..., 0] > 1e-3, d[..., 0], np.nan)
    reach = (x0 - 0.01) / ahead
    y = reach * d[..., 1] - speed * coarse.time[None, :]
    z = UP[2, 3] + reach * d[..., 2]
    inside = (np.abs(y) < 10) & (z > 0) & (z < 3)
    clear = (np.abs(np.abs(y) - 10) > 0.05) & (np.abs(z) > 0.01) & np.isfinite(y)
    np.testing.assert_array_equal((hits.winner.reshape(64, -1) == 0)[clear], inside[clear])
    assert inside[clear].sum() > 1000


def test_a_turning_ego_before_a_standing_wall(kit: SimpleNamespace, bodies: Bodies, coarse: Pattern) -> None:
    """The wall at x0 is met at x0 / (cos V cos(a + w t)): the head's azimuth and the ego's yaw then."""
    turn, x0 = 1.5, 12.0
    poses = kit.poses_of(
        coarse, lambda t: kit.at(0, 0, 0, turn * t), [("plate", lambda _: kit.at(x0, 0, 0, 0))]
    )
    hits = caster_of(coarse, bodies).cast(poses, UP)
    ring, column = np.nonzero(hits.winner.reshape(64, -1) == 0)
    yaw = coarse.rotor[column] + turn * coarse.time[column]
    want = (x0 - 0.01) / (np.cos(coarse.elevation[ring]) * np.cos(yaw))
    got = hits.distance.reshape(64, -1)[ring, column]
    front = np.abs(got - want) < 0.05  # the rest met its edge
    assert front.sum() > 0.98 * len(ring) > 500
    np.testing.assert_allclose(got[front], want[front], atol=1e-3)


def test_account_of_an_occluder(kit: SimpleNamespace, bodies: Bodies) -> None:
    grid = pattern(unit("hdl64e-s3-20171102"), 20)
    near, far = ("car", lambda _: kit.at(8, 0, 0, 1.57)), ("ped", lambda t: kit.at(12 + 5 * t, 0.4, 0, 0))
    one = caster_of(grid, bodies)
    both = one.cast(kit.poses_of(grid, lambda _: np.eye(4), [near, far]), UP)
    alone = one.cast(kit.poses_of(grid, lambda _: np.eye(4), [far]), UP)
    assert both.solo[1] == alone.solo[0] == alone.visible[0] + alone.lost_to[0].sum()
    assert both.visible[0] == both.solo[0]
    assert 0 < both.lost_to[1, 0] < both.solo[1]
    np.testing.assert_array_equal(both.solo, both.visible + both.lost_to.sum(1))
    np.testing.assert_array_equal(both.visible, [(both.winner == 0).sum(), (both.winner == 1).sum()])


def test_account_of_things_and_terrain(kit: SimpleNamespace, bodies: Bodies) -> None:
    grid = pattern(unit("hdl64e-s3-20171102"), 20)
    shape = kit.box(0.5, 4.0, 1.2)
    wall = Mesh(shape.vertices + np.array([6, 0, 0], np.float32), shape.triangles)
    poses = kit.poses_of(
        grid,
        lambda _: np.eye(4),
        [("car", lambda _: kit.at(14, 0, 0, 0)), ("car", lambda _: kit.at(-9, 0, -0.8, 0))],
    )
    hits = caster_of(grid, bodies, things=wall).cast(poses, UP)
    assert hits.lost_to[0, 2] > 100  # things
    assert hits.lost_to[1, 3] > 100  # the half that is sunk is lost to the terrain
    np.testing.assert_array_equal(hits.solo, hits.visible + hits.lost_to.sum(1))
    assert (hits.winner == THING).any()
    assert (hits.winner == TERRAIN).any()


def test_blind_rays_meet_nothing_and_count_nowhere(
    kit: SimpleNamespace, bodies: Bodies, coarse: Pattern
) -> None:
    blind = np.zeros((64, coarse.columns), bool)
    blind[:, 500:] = True
    poses = kit.poses_of(coarse, lambda _: np.eye(4), [("plate", lambda _: kit.at(10, 0, 0, 0))])
    seeing = caster_of(coarse, bodies).cast(poses, UP)
    hits = caster_of(coarse, bodies, blind=blind).cast(poses, UP)
    assert (hits.winner.reshape(64, -1)[:, 500:] == NOTHING).all()
    assert np.isinf(hits.distance.reshape(64, -1)[:, 500:]).all()
    assert hits.solo[0] == (seeing.winner.reshape(64, -1)[:, :500] == 0).sum()


def test_normals_face_the_sensor_in_its_frame_at_the_stamp(kit: SimpleNamespace, bodies: Bodies) -> None:
    grid = pattern(unit("hdl64e-utexas"), 20)
    poses = crowd(kit, grid, 3)
    hits = caster_of(grid, bodies).cast(poses, UP)
    met = hits.winner != NOTHING
    np.testing.assert_allclose(np.linalg.norm(hits.normal[met], axis=1), 1, atol=1e-5)
    ground = hits.normal[hits.winner == TERRAIN]
    want = inverse(hits.motion.edge[-1])[:3, :3] @ [0, 0, 1]
    np.testing.assert_allclose(ground, np.broadcast_to(want, ground.shape), atol=1e-4)
    assert not hits.normal[~met].any()


def test_threads_do_not_change_a_byte(
    kit: SimpleNamespace, bodies: Bodies, coarse: Pattern, monkeypatch: pytest.MonkeyPatch
) -> None:
    poses, one = crowd(kit, coarse, 11), caster_of(coarse, bodies)
    threaded = one.cast(poses, UP)
    monkeypatch.setattr(casting, "spread", lambda work, items: [work(item) for item in items])
    serial: Hits = one.cast(poses, UP)
    for field in ("distance", "winner", "triangle", "normal", "cosine", "lost_to"):
        assert getattr(threaded, field).tobytes() == getattr(serial, field).tobytes(), field


def test_poses_of_another_sweep_are_refused(kit: SimpleNamespace, coarse: Pattern) -> None:
    other = pattern(unit("hdl64e-utexas"), 10)
    with pytest.raises(SimulationError, match="edges"):
        sweep_motion(coarse, kit.poses_of(other, lambda _: np.eye(4), []), UP)


def test_a_scene_without_actors(kit: SimpleNamespace, bodies: Bodies, coarse: Pattern) -> None:
    hits = caster_of(coarse, bodies).cast(kit.poses_of(coarse, lambda _: np.eye(4), []), UP)
    assert hits.lost_to.shape == (0, 2)
    assert len(hits.solo) == 0
