from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.errors import SimulationError
from datmo.messages import Kind
from scenarios import spec
from sim.scene.roads import Road
from sim.scene.roughness import band, profile_variance
from sim.scene.terrain import Terrain, build_terrain

SEED = np.random.SeedSequence(11)
AREA = (-9.0, -6.0, 9.3, 6.1)


def built(area=AREA, roads=(), seed=SEED, **changes):
    return build_terrain(spec.Terrain(**changes), roads, area, seed)


@pytest.fixture(scope="module")
def rough():
    return built(grade=0.06, cross_slope=-0.03, roughness="G")


def moller_trumbore(origin, direction, triangles):
    """Signed distances to every triangle (t, 3, 3) along the whole line, NaN where it passes by."""
    a, e1, e2 = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    p = np.cross(direction, e2)
    det = np.einsum("ij,ij->i", e1, p)
    u = np.einsum("ij,ij->i", origin - a, p) / det
    q = np.cross(origin - a, e1)
    v = (q @ direction) / det
    hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9)
    return np.where(hit, np.einsum("ij,ij->i", e2, q) / det, np.nan)


def test_heights_and_normals_are_those_of_the_mesh(rough):
    rng = np.random.default_rng(0)
    xy = np.column_stack([rng.uniform(-8.9, 9.2, 200), rng.uniform(-5.9, 6.0, 200)])
    mesh = rough.vertices.astype(float)[rough.triangles]
    height, normal = rough.height_at(xy), rough.normal_at(xy)
    for k, (x, y) in enumerate(xy):
        t = moller_trumbore(np.array([x, y, 50.0]), np.array([0, 0, -1.0]), mesh)
        which = np.flatnonzero(np.isfinite(t))
        assert height[k] == pytest.approx(50 - t[which[0]], abs=1e-5)
        a, b, c = mesh[which[0]]
        face = np.cross(b - a, c - a)
        assert normal[k] == pytest.approx(face / np.linalg.norm(face), abs=1e-4)


def test_along_a_tilted_axis_meets_the_mesh_where_a_ray_does(rough):
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.uniform(-6, 6, (150, 2)), rng.uniform(-2, 2, 150)])
    axis = np.array([0.2, -0.1, 1.0])
    axis /= np.linalg.norm(axis)
    mesh = rough.vertices.astype(float)[rough.triangles]
    found = rough.along(points, axis)
    for point, t in zip(points, found, strict=True):
        roots = moller_trumbore(point, axis, mesh)
        assert np.nanmin(np.abs(roots - t)) < 1e-4


@settings(max_examples=30, deadline=None)
@given(
    tilt=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)),
    seed=st.integers(0, 5),
    roughness=st.sampled_from("ACEH"),
)
def test_points_moved_along_the_axis_lie_on_the_ground(tilt, seed, roughness):
    terrain = _cached(roughness)
    points = np.random.default_rng(seed).uniform((-30, -20, -3), (30, 20, 3), (300, 3))
    axis = np.array([*tilt, 1.0]) / np.sqrt(1 + tilt[0] ** 2 + tilt[1] ** 2)
    t = terrain.along(points, axis)
    landed = points + t[:, None] * axis
    assert np.isfinite(t).mean() > 0.99
    on = landed[np.isfinite(t)]
    assert np.abs(terrain.height_at(on[:, :2]) - on[:, 2]).max() < 1e-6


_made: dict[str, Terrain] = {}


def _cached(roughness):
    if roughness not in _made:
        _made[roughness] = built(roughness=roughness)
    return _made[roughness]


def test_a_flat_plane_is_exact_and_level_beyond_its_rim():
    terrain = built(grade=0.1, cross_slope=0.05)
    xy = np.array([[0.0, 0.0], [3.17, -2.2], [100.0, 0.0], [-100.0, -200.0]])
    ends = np.clip(xy, terrain.area[:2], terrain.area[2:])
    assert terrain.height_at(xy) == pytest.approx(ends @ [0.05, 0.1], abs=1e-6)
    up = np.array([0.0, 0.0, 1.0])
    assert terrain.along(np.column_stack([xy, np.ones(4)]), up) == pytest.approx(
        ends @ [0.05, 0.1] - 1, abs=1e-6
    )


def test_the_grid_covers_its_area_and_the_mesh_looks_up(rough):
    x0, y0, x1, y1 = rough.area
    assert (x0, y0) == AREA[:2]
    assert AREA[2] <= x1 < AREA[2] + rough.cell
    assert AREA[3] <= y1 < AREA[3] + rough.cell
    corners = rough.vertices[rough.triangles].astype(float)
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (faces[:, 2] > 0).all()
    assert faces[:, 2].sum() / 2 == pytest.approx((x1 - x0) * (y1 - y0), rel=1e-5)
    middle = corners[::2].mean(1)
    assert np.array_equal(rough.kind_at(middle[:, :2]), rough.kind.ravel())
    assert rough.vertices.dtype == np.float32
    assert rough.triangles.dtype == np.int32


def test_roads_carry_their_own_roughness_and_turn_smoothly_into_field():
    line = np.array([[0.0, -70.0], [0.0, 0.0], [50.0, 40.0]])
    road = Road(line, 8.0)
    area = (-60.0, -60.0, 60.0, 60.0)
    both = built(area, [road], roughness="E", road_roughness="A")
    bare = built(area, [road], roughness="flat", road_roughness="A")
    wild = built(area, [], roughness="E")
    x, y = (g.ravel() for g in np.meshgrid(np.linspace(-59, 59, 200), np.linspace(-59, -5, 150)))
    xy = np.column_stack([x, y])
    on, off = np.abs(x) < 3.5, np.abs(x) > 7.6
    left = off & (x < 0)
    assert np.array_equal(both.height_at(xy[on]), bare.height_at(xy[on]))
    assert np.array_equal(both.height_at(xy[left]), wild.height_at(xy[left]))
    assert (both.kind_at(xy[on]) == Kind.ROAD).all()
    assert (both.kind_at(xy[off]) == Kind.FIELD).all()
    paved = built(area, [Road(line, 400.0)], road_roughness="E")
    ahead = [np.diff(t.height, axis=1).ravel() for t in (wild, paved)]
    assert abs(np.corrcoef(*ahead)[0, 1]) < 0.05
    step = np.abs(np.diff(both.height, axis=1)).max()
    assert step < 2.5 * np.abs(np.diff(wild.height, axis=1)).max()


def test_built_roughness_has_the_rms_of_its_class():
    heights = [
        built((0, 0, 300, 300), seed=np.random.SeedSequence(i), roughness="C").height for i in range(4)
    ]
    variance = np.mean([h.var() for h in heights])
    assert np.sqrt(variance) == pytest.approx(
        np.sqrt(np.pi / 2 * profile_variance("C", *band(0.3))), rel=0.15
    )


def test_a_seed_gives_the_same_bytes_and_is_left_untouched():
    seed = np.random.SeedSequence(3)
    a, b = (built(roughness="D", seed=seed) for _ in range(2))
    assert a.height.tobytes() == b.height.tobytes()
    assert seed.n_children_spawned == 0
    assert built(roughness="D", seed=np.random.SeedSequence(4)).height.tobytes() != a.height.tobytes()


def test_not_a_number_in_is_not_a_number_out(rough):
    assert np.isnan(rough.height_at(np.array([[np.nan, 0.0], [0.0, np.nan]]))).all()
    assert np.isnan(rough.along(np.array([[0.0, np.nan, 0.0]]), np.array([0.0, 0.0, 1.0]))).all()


@pytest.mark.parametrize("area", [(0, 0, 0, 1), (1, 0, 0, 1), (0, 0, np.nan, 1), (0, 0, 1e5, 1e5)])
def test_an_impossible_area_is_refused(area):
    with pytest.raises(SimulationError, match=r"area|heights"):
        built(area)


@pytest.mark.parametrize(
    ("line", "width"), [([[0, 0]], 3), ([[0, 0], [1, np.inf]], 3), ([[0, 0], [1, 1]], 0)]
)
def test_an_impossible_road_is_refused(line, width):
    with pytest.raises(SimulationError, match="road"):
        Road(np.array(line, float), width)
