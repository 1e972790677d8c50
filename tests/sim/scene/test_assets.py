from __future__ import annotations

import numpy as np
import pytest
import trimesh

from datmo.errors import DatmoError
from datmo.messages import Kind
from sim.scene import assets
from sim.scene.bodies import materials, primitives
from sim.scene.vehicles import DRIVEN, body, fleet

PUBLISHED = {
    "car/0": (4.284, 1.789, 1.456),
    "car/1": (4.885, 1.840, 1.445),
    "car/2": (4.600, 1.855, 1.685),
    "car/3": (3.546, 1.627, 1.488),
    "car/4": (4.767, 1.832, 1.477),
    "car/5": (5.325, 1.855, 1.815),
    "van/0": (4.904, 1.904, 1.990),
    "van/1": (5.932, 2.020, 2.630),
    "truck/0": (8.4, 2.5, 3.4),
    "truck/1": (10.6, 2.55, 3.8),
    "truck/2": (16.5, 2.55, 4.0),
    "bus/0": (11.95, 2.55, 3.076),
}
VEHICLES = list(PUBLISHED)
WALKERS = [f"pedestrian/{v}/{p}" for v in range(4) for p in (0, 3, 7, 12)]
WALKERS += ["pedestrian/1", "pedestrian/4/2", "pedestrian/5/run/3", "pedestrian/6/0", "pedestrian/7/run/12"]


def forms_of(key):
    """A person at rest and at all phases of both gaits; else the key alone."""
    if not key.startswith("pedestrian"):
        return (key,)
    still = assets.at_rest(key)
    return still, *(assets.at_phase(still, p, g) for g in ("walk", "run") for p in range(assets.GAIT_PHASES))


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
    forms = [assets.asset(k) for k in forms_of(key)]
    low = np.min([f.vertices.min(0) for f in forms], 0)
    high = np.max([f.vertices.max(0) for f in forms], 0)
    assert a.size == tuple(np.float32(high - low).astype(float))
    assert all(f.size == a.size for f in forms)
    assert (low[:2] + high[:2]) == pytest.approx(0, abs=1e-6)
    assert low[2] == a.vertices[:, 2].min() == 0
    assert (a.vertices.dtype, a.triangles.dtype, a.reflectivity.dtype) == (np.float32, np.int32, np.float32)
    assert len(a.triangles) == len(a.reflectivity)
    assert 300 < len(a.triangles) < 3000
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
    x = on_ground[:, 0]
    return float(x[x > x.max() - 0.5].mean())


@pytest.mark.parametrize("key", [k for k in VEHICLES if k.startswith("car")])
def test_a_car_has_a_bonnet_lower_than_its_roof_and_dark_sloped_screens(key):
    a = assets.asset(key)
    length, _, height = a.size
    bonnet, at = distance_between(a, (0.36 * length, 0, 10), (0, 0, -1))
    assert 10 - bonnet < 0.72 * height
    assert a.reflectivity[at] > 2 * materials.GLASS
    middle, normal = faces(a)
    glass = a.reflectivity == np.float32(materials.GLASS)
    up = normal[:, 2] / np.linalg.norm(normal, axis=1)
    ahead = glass & (normal[:, 0] > 0) & (np.abs(normal[:, 1]) < np.abs(normal[:, 0]))
    slope = np.degrees(np.arccos(up[ahead & (middle[:, 0] > 0)]))
    assert len(slope)
    assert 20 < np.median(slope) < 60  # from level; windscreens lean back by 30 to 65 degrees
    assert np.linalg.norm(normal[glass], axis=1).sum() > 1.5  # square metres


def test_keys_and_makers_agree_and_assets_are_made_once():
    for kind, name, count in ((Kind.CAR, "car", 6), (Kind.VAN, "van", 2), (Kind.TRUCK, "truck", 3)):
        assert assets.keys(kind) == tuple(f"{name}/{i}" for i in range(count))
    assert len(assets.keys(Kind.PEDESTRIAN)) == 8
    for kind in (*DRIVEN.values(), Kind.PEDESTRIAN):
        assert all(assets.asset(k).kind == kind for k in assets.keys(kind))
    assert assets.car(2) is assets.asset("car/2")
    assert assets.asset("car/2~0") is assets.asset("car/2")
    assert assets.pedestrian(5, 1) is assets.asset("pedestrian/1/5")
    with pytest.raises(ValueError, match="read-only"):
        assets.car(0).vertices[0] = 0


def test_the_catalogue_names_every_variant_once_and_says_what_it_is():
    listed = assets.catalogue()
    assert len(set(listed)) == len(listed) == 6 + 2 + 3 + 8 + 1 + 2 + 2
    assert {assets.asset(k).kind for k in listed} == {*DRIVEN.values(), Kind.PEDESTRIAN}
    assert assets.describe("car/0") == "hatchback, 4.3 x 1.8 x 1.5 m"
    assert assets.describe("pedestrian/4/run/3~2").startswith("child of six, 0.")


@pytest.mark.parametrize(
    "key",
    ["car/6", "cat/0", "car/0/1", "car/00", "car/0~32", "car/0~01", "pedestrian/0/16", "pedestrian/-1/0",
     "pedestrian/0/run", "pedestrian/0/walk/3", "bicycle/0/run/3", "motorcycle/0/1", "", "car/0 "],
)  # fmt: skip
def test_an_unknown_key_is_refused(key):
    with pytest.raises(DatmoError, match="no asset"):
        assets.asset(key)


def test_what_has_no_mesh_or_no_gait_is_named():
    with pytest.raises(DatmoError, match="no mesh of kind ROAD"):
        assets.keys(Kind.ROAD)
    with pytest.raises(DatmoError, match="has no gait"):
        assets.at_phase("car/0", 3)
    with pytest.raises(DatmoError, match="did you mean 'run'"):
        assets.at_phase("pedestrian/0", 3, "runn")
    with pytest.raises(DatmoError, match="did you mean 'car/1'"):
        assets.asset("cra/1")


def test_phases_of_one_body_have_keys_of_its_seed():
    assert assets.at_phase("pedestrian/2~9", 19) == "pedestrian/2/3~9"
    assert assets.at_phase("pedestrian/2/5~9", 3, "run") == "pedestrian/2/run/3~9"
    assert assets.at_rest("pedestrian/2/run/3~9") == "pedestrian/2~9"
    assert assets.at_phase("bicycle/1", 2) == "bicycle/1/2"
    assert assets.cycle("pedestrian/0/run/3") == assets.stride(0, "run") == pytest.approx(1.2 * 1.76)
    assert assets.cycle("pedestrian/0~4") == assets.stride(0, seed=4) != assets.stride(0)
    assert assets.cycle("car/0") == 0


def test_a_mix_of_traffic_spreads_each_share_over_its_variants():
    made, weight = fleet({"car": 3, "bus": 1, "truck": 0})
    assert made == (*assets.keys(Kind.CAR), "bus/0", *assets.keys(Kind.TRUCK))
    assert weight == pytest.approx([0.125] * 6 + [0.25] + [0] * 3)
    for wrong, message in (({"cra": 1}, "mean 'car'"), ({"car": -1}, "0 or more"), ({"car": 0}, "above 0")):
        with pytest.raises(DatmoError, match=message):
            fleet(wrong)
    assert fleet({"car": np.nextafter(0, 1)})[1].sum() == pytest.approx(1)


def test_a_body_has_the_size_of_its_mesh():
    made = body("truck/2~3")
    assert (made.length, made.width, made.height) == assets.asset("truck/2~3").size
    assert made.kind == Kind.TRUCK


def test_a_box_and_a_ball_enclose_their_volumes():
    cube = primitives.box((1, 2, 3), (2, 3, 4), 0.5)
    ball = primitives.ellipsoid((0, 0, 0), (2, 2, 2), 0.5, 60)
    for shell, volume in ((cube, 24), (ball, 4 / 3 * np.pi)):
        assert trimesh.Trimesh(shell.vertices, shell.triangles).volume == pytest.approx(volume, rel=0.01)
    assert cube.vertices.mean(0) == pytest.approx([1, 2, 3])
