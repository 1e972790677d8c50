"""The coarser mesh far from the roads is the surface that the grid says."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.messages import Kind
from scenarios import spec
from sim.scan.embree import MISS, Mesh
from sim.scene.roads import Road
from sim.scene.terrain import build_terrain
from sim.scene.terrain.far import FACTOR, corners

ROADS = [Road(np.array([[-60.0, -30.0], [60.0, 45.0]]), 7.0)]
AREA = (-40.0, -40.0, 41.3, 40.7)


@pytest.fixture(autouse=True)
def _no_cache(monkeypatch):
    monkeypatch.setenv("DATMO_CACHE_DIR", "off")


def built(beyond, **changes):
    ground = spec.Terrain(cell=0.5, roughness="F", grade=0.05, coarse_beyond=beyond, **changes)
    return build_terrain(ground, ROADS, AREA, np.random.SeedSequence(2))


@pytest.fixture(scope="module")
def far():
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DATMO_CACHE_DIR", "off")
        return built(10.0)


def cast_down(terrain, xy):
    mesh = Mesh(terrain.vertices, terrain.triangles)
    origins = np.column_stack([xy, np.full(len(xy), 30.0)]).astype(np.float32)
    down = np.tile(np.array([[0, 0, -1]], np.float32), (len(xy), 1))
    return mesh.cast(origins, down), origins[:, :2].astype(float)


def test_rays_meet_the_coarse_mesh_where_the_grid_says(far):
    xy = np.random.default_rng(0).uniform(AREA[:2], AREA[2:], (20000, 2))
    hits, xy = cast_down(far, xy)
    assert (hits.distance < MISS).all()
    assert 30 - hits.distance == pytest.approx(far.height_at(xy), abs=2e-5)
    normal = hits.normal / np.linalg.norm(hits.normal, axis=1)[:, None]
    near_an_edge = np.abs(normal - far.normal_at(xy)).max(1) > 1e-4
    assert near_an_edge.mean() < 1e-3
    assert np.array_equal(far.mesh_kind[hits.triangle // 2], far.kind_at(xy))


def test_no_ray_slips_between_fine_and_coarse(far):
    """Rays along the nodes' own lines, where tiles meet."""
    x = far.x0 + far.cell * np.arange(1, far.height.shape[1] - 1)
    y = far.y0 + far.cell * FACTOR * np.arange(1, (far.height.shape[0] - 1) // FACTOR)
    X, Y = np.meshgrid(x + 0.11, y)
    hits, _ = cast_down(far, np.column_stack([X.ravel(), Y.ravel()]))
    assert (hits.distance < MISS).all()


def test_near_the_road_nothing_changes_and_far_off_there_are_fewer_triangles(far):
    fine = built(None)
    xy = np.random.default_rng(1).uniform(AREA[:2], AREA[2:], (5000, 2))
    near = fine.kind_at(xy) == Kind.ROAD
    assert near.sum() > 100
    assert np.array_equal(far.height_at(xy[near]), fine.height_at(xy[near]))
    assert len(far.triangles) < 0.6 * len(fine.triangles)
    assert np.array_equal(
        far.height[:: FACTOR * 10, :: FACTOR * 10], fine.height[:: FACTOR * 10, :: FACTOR * 10]
    )
    assert np.abs(far.height - fine.height).max() < 0.3


def test_cells_and_tiles_cover_the_ground_once(far):
    cells, tiles = corners(far.height.shape, far.coarse)
    ny, nx = far.height.shape
    assert len(cells) + FACTOR**2 * len(tiles) == (ny - 1) * (nx - 1)
    face = far.vertices[far.triangles].astype(float)
    area = np.cross(face[:, 1] - face[:, 0], face[:, 2] - face[:, 0])[:, 2] / 2
    assert (area > 0).all()
    assert area.sum() == pytest.approx((nx - 1) * (ny - 1) * far.cell**2, rel=1e-6)
    assert len(far.mesh_kind) * 2 == len(far.triangles)


def test_what_goes_with_the_roads_stays_fine():
    layers = [{"kind": "kerb", "sidewalk": 6.0}, {"kind": "ditch", "offset": 12.0}]
    near, wide = built(0.0, layers=layers), built(None, layers=layers)
    assert near.coarse is not None
    walk = near.kind == Kind.SIDEWALK
    assert walk.any()
    assert np.array_equal(near.height[:-1, :-1][walk], wide.height[:-1, :-1][walk])
    xy = np.random.default_rng(2).uniform(AREA[:2], AREA[2:], (4000, 2))
    hits, xy = cast_down(near, xy)
    assert np.array_equal(near.mesh_kind[hits.triangle // 2], near.kind_at(xy))


def test_without_roads_or_the_key_every_cell_is_fine():
    fine = built(None)
    assert fine.coarse is None
    assert np.array_equal(fine.mesh_kind, fine.kind.ravel())
    alone = build_terrain(spec.Terrain(cell=0.5, coarse_beyond=5), [], AREA, np.random.SeedSequence(2))
    assert alone.coarse is None
