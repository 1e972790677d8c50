"""What holds for every ground: one of each layer, and each class of roughness."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from datmo.messages import Kind
from scenarios.spec import layers
from sim.picture.grounds import LAYERS, ground, ground_names
from sim.picture.terrain import terrain_view
from sim.scan.embree import MISS, Mesh
from sim.scene.terrain import Terrain

FEW = ("plane", "bank", "potholes", "iso-e")
GIVEN = [name if name in FEW else pytest.param(name, marks=pytest.mark.long) for name in ground_names()]


@pytest.fixture(scope="module", params=GIVEN)
def built(request) -> Terrain:
    return ground(request.param)


def test_rays_meet_the_ground_where_it_says_it_is(built):
    xy = np.random.default_rng(0).uniform(-39, 39, (4000, 2)).astype(np.float32)
    origins = np.column_stack([xy, np.full(len(xy), 20.0)]).astype(np.float32)
    down = np.tile(np.array([[0, 0, -1]], np.float32), (len(xy), 1))
    hits = Mesh(built.vertices, built.triangles).cast(origins, down)
    assert (hits.distance < MISS).all()
    assert 20 - hits.distance == pytest.approx(built.height_at(xy), abs=1e-4)
    found = built.kind_at(xy)
    assert np.array_equal(built.mesh_kind[hits.triangle // 2], found)
    assert set(found.tolist()) <= {Kind.ROAD, Kind.SIDEWALK, Kind.FIELD}
    assert {Kind.ROAD, Kind.FIELD} <= set(found.tolist())


def test_it_is_finite_float32_and_has_upward_normals(built):
    assert np.isfinite(built.height).all()
    assert np.array_equal(built.height, built.height.astype(np.float32))
    normal = built.normal_at(np.random.default_rng(1).uniform(-39, 39, (500, 2)))
    assert np.sqrt(np.sum(normal**2, 1)) == pytest.approx(np.ones(500))
    assert (normal[:, 2] > 0.05).all()


@pytest.mark.parametrize("name", ["hills", "kerb", "iso-h"])
def test_it_shows_in_a_picture(name):
    image = terrain_view(ground(name), 60)
    assert image.shape == (36, 60, 3)
    assert image.std() > 5


def test_each_kind_of_layer_has_a_ground_to_show():
    shown = {layer["kind"] for each in LAYERS.values() for layer in each}
    known = {m.model_fields["kind"].default for m in get_args(get_args(layers.Layer)[0])}
    assert shown == known


@pytest.mark.long
def test_the_cache_holds_the_bytes_of_every_ground(monkeypatch):
    kept = [ground(name) for name in ("hills", "bank", "kerb")]
    again = [ground(name) for name in ("hills", "bank", "kerb")]
    monkeypatch.setenv("DATMO_CACHE_DIR", "off")
    anew = [ground(name) for name in ("hills", "bank", "kerb")]
    for a, b, c in zip(kept, again, anew, strict=True):
        assert a.height.tobytes() == b.height.tobytes() == c.height.tobytes()
        assert a.kind.tobytes() == b.kind.tobytes() == c.kind.tobytes()
