"""What holds for every kind of thing, whatever its seed, on rough and sloping ground."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
import trimesh
from hypothesis import example, given, settings
from hypothesis import strategies as st

from datmo.errors import SimulationError
from datmo.messages import Kind
from scenarios import spec
from scenarios.spec.things import ThingKind
from sim.scan.embree import MISS, Mesh
from sim.scene.bodies.primitives import loft
from sim.scene.scenery.kinds import SORTS, drawn, form, sort
from sim.scene.scenery.place import size_of, stand
from sim.scene.terrain import build_terrain

KINDS = sorted(SORTS)
SEEDS = (0, 1, 2, 5, 11)
ROOT = 0.3


@pytest.fixture(scope="module")
def rough():
    model = spec.Terrain(grade=0.12, cross_slope=-0.05, roughness="E")
    return build_terrain(model, [], (-25, -25, 25, 25), np.random.SeedSequence(3))


@pytest.fixture(scope="module")
def slope():
    return build_terrain(spec.Terrain(grade=0.2), [], (-20, -20, 20, 20), np.random.SeedSequence(0))


def test_every_kind_of_the_schema_can_be_made():
    assert set(get_args(ThingKind)) == set(SORTS)
    with pytest.raises(SimulationError, match="hedge"):
        sort("hedg")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", SEEDS)
def test_it_is_within_its_published_size_and_fills_it(kind, seed):
    size, least, most = np.array(drawn(kind, seed)), SORTS[kind].least, SORTS[kind].most
    assert (np.array(least) <= size).all()
    assert (size <= np.array(most)).all()
    made = form(kind, drawn(kind, seed), seed)
    low, high = made.vertices.min(0), made.vertices.max(0)
    across = 0.5 if kind != "lamp" else 1.0  # a lamp's arm reaches its whole width to one side
    assert (np.maximum(-low, high)[:2] <= across * size[:2] + 1e-6).all()
    assert high[2] <= size[2] + 1e-6
    assert high[2] >= 0.9 * size[2]
    assert (high - low)[0] >= 0.5 * size[0]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", SEEDS)
def test_it_is_sound_and_its_foot_is_in_the_ground(kind, seed, rough):
    thing = spec.Thing(kind=kind, at=(3.3, -4.7), yaw_deg=37.0 * seed, seed=seed)
    a = stand(thing, rough)
    assert (a.vertices.dtype, a.triangles.dtype, a.kind.dtype) == (np.float32, np.int32, np.uint8)
    assert np.isfinite(a.vertices).all()
    assert len(a.triangles) == len(a.kind) == len(a.reflectivity)
    assert ((a.reflectivity > 0) & (a.reflectivity <= 1)).all()
    assert SORTS[kind].kind in a.kind
    assert a.triangles.min() >= 0
    assert a.triangles.max() < len(a.vertices)
    above = a.vertices[:, 2] - rough.height_at(a.vertices[:, :2].astype(float))
    assert above.min() < 0.0
    assert above.min() > -2.0
    b = stand(thing, rough)
    assert a.vertices.tobytes() == b.vertices.tobytes()
    assert a.triangles.tobytes() == b.triangles.tobytes()


@pytest.mark.parametrize("kind", ["wall", "fence", "rail", "hedge", "building", "grass"])
def test_no_gap_shows_below_what_is_long(kind, rough):
    """Each vertex near the ground is below it, so a ray along the ground meets the thing or the ground."""
    for seed in SEEDS:
        thing = spec.Thing(kind=kind, at=(-2.0, 3.0), yaw_deg=20.0, seed=seed)
        own = form(kind, size_of(thing), seed)
        placed = stand(thing, rough).vertices.astype(float)
        rooted = own.vertices[:, 2] < -0.05
        assert rooted.sum() >= 4
        assert (placed[rooted, 2] < rough.height_at(placed[rooted, :2])).all()


@pytest.mark.parametrize(
    "kind",
    sorted(set(KINDS) - {"pole", "lamp", "traffic_light", "bollard", "bin", "container", "wall", "rail"}),
)
def test_seeds_give_different_shapes_of_one_size(kind):
    size = drawn(kind, 0)
    shapes = {form(kind, size, seed).vertices.tobytes() for seed in range(4)}
    assert len(shapes) >= 2


@pytest.mark.parametrize("kind", KINDS)
def test_seeds_give_different_sizes(kind):
    assert len({drawn(kind, seed) for seed in range(8)}) > 4


SIDE = st.floats(0.2, 20)


@settings(max_examples=80, deadline=None)
@given(st.sampled_from(KINDS), SIDE, SIDE, SIDE, st.integers(0, 9))
@example("bush", 13.75, 0.25, 9.0, 0)
def test_any_size_makes_a_sound_shape(kind, length, width, height, seed):
    made = form(kind, (length, width, height), seed)
    assert np.isfinite(made.vertices).all()
    assert len(made.triangles) > 0
    assert made.triangles.max() < len(made.vertices)
    assert Mesh(made.vertices, made.triangles).triangles.shape == made.triangles.shape
    if kind in ("pole", "wall", "hedge", "tree", "bush", "bollard"):
        high = np.abs(made.vertices).max(0)
        assert (high[:2] <= np.array([length, width]) / 2 + 0.15).all()


def passed(kind, seed, size, level, spread):
    """Share of level rays through the middle of a thing, from all around, that meet nothing."""
    made, rng, n = form(kind, size, seed), np.random.default_rng(seed), 1500
    turn, off = rng.uniform(0, 2 * np.pi, n), rng.uniform(-spread, spread, n)
    z = level + rng.uniform(-spread, spread, n)
    way = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
    origin = -30 * way + np.column_stack([-off * np.sin(turn), off * np.cos(turn), z])
    hits = Mesh(made.vertices, made.triangles).cast(origin.astype(np.float32), way.astype(np.float32))
    return float((hits.distance >= MISS).mean())


def test_a_crown_lets_a_share_of_the_rays_pass():
    shares = [passed("tree", seed, (6.0, 6.0, 9.0), 5.8, 0.8) for seed in range(8)]
    assert all(0.05 <= share <= 0.25 for share in shares), shares
    assert 0.08 <= np.mean(shares) <= 0.18


@pytest.mark.parametrize(
    ("kind", "level", "spread", "low", "high"),
    [("conifer", 0.35, 0.8, 0.02, 0.3), ("bush", 0.5, 0.1, 0.02, 0.35), ("grass", 0.4, 0.1, 0.05, 0.6)],
)
def test_other_plants_are_porous_too(kind, level, spread, low, high):
    shares = [passed(kind, seed, size := drawn(kind, seed), level * size[2], spread) for seed in range(6)]
    assert all(low <= share <= high for share in shares), shares


def test_a_ray_meets_a_crown_at_many_depths():
    made = form("tree", (6.0, 6.0, 9.0), 3)
    y, z = (a.ravel() for a in np.meshgrid(np.linspace(-1, 1, 40), np.linspace(4.8, 6.8, 40)))
    origin = np.column_stack([np.full(1600, -20.0), y, z]).astype(np.float32)
    way = np.tile(np.array([[1, 0, 0]], np.float32), (1600, 1))
    depth = Mesh(made.vertices, made.triangles).cast(origin, way).distance - 17
    depth = depth[depth < 10]
    assert np.std(depth) > 0.8
    assert np.quantile(depth, 0.9) - np.quantile(depth, 0.1) > 2.0


def test_trees_are_of_trunk_and_leaves():
    made = form("tree", drawn("tree", 0), 0)
    assert set(made.kind.tolist()) == {Kind.TRUNK, Kind.VEGETATION}
    corners = made.vertices[made.triangles[made.kind == Kind.VEGETATION]]
    assert corners[..., 2].min() > 1.5


def test_signs_shine_towards_the_traffic_only():
    made = form("sign", drawn("sign", 0), 0)
    middle = made.vertices[made.triangles].mean(1)
    bright = made.reflectivity > 0.9
    assert bright.any()
    assert (made.kind[bright] == Kind.SIGN).all()
    assert (middle[bright, 0] < -0.04).all()


def test_rays_pass_a_fence_and_not_a_wall():
    y = np.zeros(900)
    x, z = (a.ravel() for a in np.meshgrid(np.linspace(-4, 4, 30), np.linspace(0.1, 1.1, 30)))
    origin = np.column_stack([x, y - 5, z]).astype(np.float32)
    way = np.tile(np.array([[0, 1, 0]], np.float32), (900, 1))
    shares = {}
    for kind, seed in (("wall", 0), ("fence", 0), ("fence", 1), ("hedge", 0)):
        made = form(kind, (10.0, 0.5, 1.4), seed)
        shares[kind, seed] = (Mesh(made.vertices, made.triangles).cast(origin, way).distance >= MISS).mean()
    assert shares["wall", 0] == 0
    assert 0.45 < shares["fence", 0] < 0.75
    assert 0.15 < shares["fence", 1] < 0.5
    assert shares["hedge", 0] < 0.02


def test_a_building_has_panes_behind_its_facade():
    made = form("building", (14.0, 10.0, 9.0), 1)
    glass = made.reflectivity < 0.1
    assert glass.sum() >= 2 * 2 * 10
    assert (made.kind == Kind.BUILDING).all()
    pane = np.abs(made.vertices[made.triangles[glass]])
    assert ((pane[..., 0].max() < 7.0) & (pane[..., 1].max() < 5.0)).all()


def test_a_pole_stands_rooted_in_the_ground(slope):
    a = stand(spec.Thing(kind="pole", at=(3, 5), size=(0.2, 0.2, 4)), slope)
    assert set(a.kind.tolist()) == {Kind.POLE}
    assert a.vertices[:, :2].mean(0) == pytest.approx([3, 5], abs=1e-4)
    assert (a.vertices[:, 2].min(), a.vertices[:, 2].max()) == pytest.approx((0.7, 5.0), abs=1e-4)
    assert trimesh.Trimesh(a.vertices, a.triangles, process=False).volume > 0


def test_a_wall_follows_the_slope(slope):
    a = stand(spec.Thing(kind="wall", at=(0, 0), size=(10, 0.3, 2), yaw_deg=90), slope)
    assert set(a.kind.tolist()) == {Kind.WALL}
    assert a.size == (10, 0.3, 2)
    assert np.ptp(a.vertices[:, :2], axis=0) == pytest.approx([0.3, 10], abs=1e-4)
    above = a.vertices[:, 2] - slope.height_at(a.vertices[:, :2].astype(float))
    assert np.unique(np.round(above, 3)) == pytest.approx([-ROOT, 0.85, 2.0], abs=2e-3)


def test_poles_have_the_bytes_they_had_when_lofted_in_the_world(rough):
    at, turn = np.array([3.0, 5.0]), 2 * np.pi * np.arange(12) / 12
    ring = np.column_stack([0.1 * np.cos(turn), 0.1 * np.sin(turn)]) + at
    ground = float(rough.height_at(at[None])[0])
    rings = [np.column_stack([ring, np.full(12, z)]) for z in (ground - ROOT, ground + 4.0)]
    shell = loft(np.stack(rings), 0.3)
    a = stand(spec.Thing(kind="pole", at=(3, 5), size=(0.2, 0.2, 4)), rough)
    assert a.vertices.tobytes() == shell.vertices.astype(np.float32).tobytes()
    assert np.array_equal(a.triangles, shell.triangles)
