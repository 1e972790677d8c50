from __future__ import annotations

import numpy as np
import pytest
import trimesh

from datmo.errors import DatmoError
from datmo.messages import Kind
from sim.scene import assets
from sim.scene.bodies import person, primitives
from sim.scene.bodies.person import PERSONS

PUBLISHED = {
    "car/0": (4.284, 1.789, 1.456),
    "car/1": (4.885, 1.840, 1.445),
    "car/2": (4.600, 1.855, 1.685),
    "car/3": (3.546, 1.627, 1.488),
    "van/0": (4.904, 1.904, 1.990),
    "van/1": (5.932, 2.020, 2.630),
    "truck/0": (8.4, 2.5, 3.4),
    "truck/1": (10.6, 2.55, 3.8),
}
VEHICLES = list(PUBLISHED)
WALKERS = [f"pedestrian/{v}/{p}" for v in range(4) for p in (0, 3, 7, 12)] + ["pedestrian/1"]


def faces(asset):
    """Middles (t, 3), area-weighted normals (t, 3)."""
    a, b, c = np.moveaxis(asset.vertices.astype(float)[asset.triangles], 1, 0)
    return (a + b + c) / 3, np.cross(b - a, c - a) / 2


def distance_between(asset, origin, direction):
    """Nearest hit of a ray and its triangle, (inf, -1) for none."""
    v = asset.vertices.astype(float)[asset.triangles]
    a, e1, e2 = v[:, 0], v[:, 1] - v[:, 0], v[:, 2] - v[:, 0]
    origin, direction = np.asarray(origin, float), np.asarray(direction, float)
    p = np.cross(direction, e2)
    det = np.einsum("ij,ij->i", e1, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.einsum("ij,ij->i", origin - a, p) / det
        q = np.cross(origin - a, e1)
        w, t = (q @ direction) / det, np.einsum("ij,ij->i", e2, q) / det
        hit = (np.abs(det) > 1e-14) & (u >= 0) & (w >= 0) & (u + w <= 1) & (t > 0)
    return (t[hit].min(), np.flatnonzero(hit)[t[hit].argmin()]) if hit.any() else (np.inf, -1)


@pytest.mark.parametrize("key", VEHICLES + WALKERS)
def test_size_is_the_bounds_and_the_box_stands_on_the_origin(key):
    a = assets.asset(key)
    low, high = a.vertices.min(0), a.vertices.max(0)
    assert a.size == tuple(np.float32(high - low).astype(float))
    assert (low[:2] + high[:2]) == pytest.approx(0, abs=1e-6)
    assert low[2] == 0
    assert (a.vertices.dtype, a.triangles.dtype, a.reflectivity.dtype) == (np.float32, np.int32, np.float32)
    assert len(a.triangles) == len(a.reflectivity)
    assert 300 < len(a.triangles) < 2600
    assert ((a.reflectivity > 0) & (a.reflectivity <= 1)).all()


@pytest.mark.parametrize(("key", "size"), PUBLISHED.items())
def test_vehicles_have_their_makers_measures(key, size):
    assert assets.asset(key).size == pytest.approx(size, abs=2e-3)


@pytest.mark.parametrize("key", VEHICLES + WALKERS)
def test_surfaces_are_closed_and_face_outwards(key):
    """Every edge is walked once each way (welded), each part encloses a positive volume."""
    a = assets.asset(key)
    normal = faces(a)[1]
    assert np.linalg.norm(normal, axis=1).min() > 1e-9
    assert normal.sum(0) == pytest.approx(0, abs=1e-4)
    mesh = trimesh.Trimesh(a.vertices, a.triangles, process=False)
    mesh.merge_vertices(digits_vertex=7)
    parts = mesh.split(only_watertight=False)
    assert len(parts) >= 8
    for part in parts:
        assert part.volume > 0
        assert abs(part.area_faces @ part.face_normals).max() < 2e-4


@pytest.mark.parametrize("key", VEHICLES)
def test_a_ray_from_above_meets_the_roof_and_one_from_the_side_a_tyre(key):
    a = assets.asset(key)
    length, width, height = a.size
    roof, _ = distance_between(a, (-0.1 * length, 0, 10), (0, 0, -1))
    assert 10 - roof == pytest.approx(height, abs=0.06 * height)
    for y in (1, -1):
        wheel, at = distance_between(a, (_front_wheel(a), 10 * y, 0.06), (0, -y, 0))
        assert wheel == pytest.approx(10 - width / 2, abs=0.1)
        assert a.reflectivity[at] < 0.1
    through, _ = distance_between(a, (_front_wheel(a) - 0.9, 10, 0.1), (0, -1, 0))
    assert through == np.inf  # one sees under it, between the axles


def _front_wheel(a):
    """x at which the front tyres stand."""
    on_ground = a.vertices[a.vertices[:, 2] < 1e-4]
    return float(on_ground[on_ground[:, 0] > 0.1 * a.size[0], 0].mean())


@pytest.mark.parametrize("key", [k for k in VEHICLES if k.startswith("car")])
def test_a_car_has_a_bonnet_lower_than_its_roof_and_dark_sloped_screens(key):
    a = assets.asset(key)
    length, _, height = a.size
    bonnet, at = distance_between(a, (0.36 * length, 0, 10), (0, 0, -1))
    assert 10 - bonnet < 0.72 * height
    assert a.reflectivity[at] > 0.1
    middle, normal = faces(a)
    glass = a.reflectivity == np.float32(0.05)
    up = normal[:, 2] / np.linalg.norm(normal, axis=1)
    ahead = glass & (normal[:, 0] > 0) & (np.abs(normal[:, 1]) < np.abs(normal[:, 0]))
    slope = np.degrees(np.arccos(up[ahead & (middle[:, 0] > 0)]))
    assert len(slope)
    assert 20 < np.median(slope) < 60  # from level; windscreens lean back by 30 to 65 degrees
    assert np.linalg.norm(normal[glass], axis=1).sum() > 1.5  # square metres


@pytest.mark.parametrize("variant", range(4))
def test_a_walker_steps_with_both_feet_and_swings_arms_against_them(variant):
    lengths = [assets.pedestrian(p, variant).size[0] for p in range(assets.GAIT_PHASES)]
    h = PERSONS[variant].height
    assert max(lengths) - min(lengths) > 0.2 * h
    for p in range(8):  # half a cycle on, left has become right
        a, b = person.person(variant, p), person.person(variant, p + 8)
        mirrored = a.vertices * [1, -1, 1]
        assert sorted(np.round(mirrored[:, 2], 6)) == sorted(np.round(b.vertices[:, 2], 6))
        assert np.round(mirrored.min(0), 6) == pytest.approx(np.round(b.vertices.min(0), 6), abs=1e-5)
    for p in range(assets.GAIT_PHASES):
        assert assets.pedestrian(p, variant).size[2] == pytest.approx(h, rel=0.03)
    assert assets.pedestrian(None, variant).size[2] == pytest.approx(h, rel=0.01)
    assert assets.stride(variant) == pytest.approx(0.83 * h)


@pytest.mark.parametrize("variant", range(4))
def test_the_stance_foot_goes_back_as_fast_as_the_body_goes_on(variant):
    """While it rests on the ground it slips by under a tenth of the stride."""
    ankles = []
    for cycle in (0.15, 0.45):
        pose = person._walking(cycle)
        thigh, shank = 0.245 * person._ahead(pose.hip), 0.246 * person._ahead(pose.hip - pose.knee)
        ankles.append(((thigh + shank) * PERSONS[variant].height)[0])
    assert ankles[0] - ankles[1] == pytest.approx(
        0.3 * assets.stride(variant), abs=0.1 * assets.stride(variant)
    )


def test_keys_and_makers_agree_and_assets_are_made_once():
    for kind, name, count in ((Kind.CAR, "car", 4), (Kind.VAN, "van", 2), (Kind.TRUCK, "truck", 2)):
        assert assets.keys(kind) == tuple(f"{name}/{i}" for i in range(count))
    assert len(assets.keys(Kind.PEDESTRIAN)) == 4
    for kind in (Kind.CAR, Kind.VAN, Kind.TRUCK, Kind.PEDESTRIAN):
        assert all(assets.asset(k).kind == kind for k in assets.keys(kind))
    assert assets.car(2) is assets.asset("car/2")
    assert assets.pedestrian(5, 1) is assets.asset("pedestrian/1/5")
    with pytest.raises(ValueError, match="read-only"):
        assets.car(0).vertices[0] = 0


@pytest.mark.parametrize("key", ["car/4", "cat/0", "pedestrian/0/16", "pedestrian/-1/0", ""])
def test_an_unknown_key_names_its_neighbours(key):
    with pytest.raises(DatmoError, match="no asset"):
        assets.asset(key)
    with pytest.raises(DatmoError, match="no mesh of kind BUS"):
        assets.keys(Kind.BUS)


def test_a_box_and_a_ball_enclose_their_volumes():
    cube = primitives.box((1, 2, 3), (2, 3, 4), 0.5)
    ball = primitives.ellipsoid((0, 0, 0), (2, 2, 2), 0.5, 60)
    for shell, volume in ((cube, 24), (ball, 4 / 3 * np.pi)):
        assert trimesh.Trimesh(shell.vertices, shell.triangles).volume == pytest.approx(volume, rel=0.01)
    assert cube.vertices.mean(0) == pytest.approx([1, 2, 3])
