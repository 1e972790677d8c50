from __future__ import annotations

import numpy as np
import pytest

from datmo.arrays import F64
from datmo.messages import Kind
from scenarios import spec
from sim.scan.embree import Mesh
from sim.scan.truth import ground_below, relief
from sim.scene.terrain import Terrain, build_terrain

EYE = np.array([0.0, 0.0, 0.2])


def pose(z: float, pitch: float = 0.0) -> F64:
    c, s = np.cos(pitch), np.sin(pitch)
    return np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, z], [0, 0, 0, 1.0]])


@pytest.fixture(scope="module")
def ridge() -> Terrain:
    """Flat but for a ridge 1 m high across x = 10."""
    x = np.arange(-30, 30.5, 0.5)
    height = np.broadcast_to(np.maximum(0, 1 - np.abs(x - 10)), (121, 121)).copy()
    return Terrain(-30.0, -30.0, 0.5, height, np.full((120, 120), Kind.FIELD, np.uint8))


def test_a_ridge_hides_what_a_straight_line_says(ridge: Terrain) -> None:
    """From 1.93 m up a crest of 1 m at 10 m hides the flat ground up to 10 / (1 - 1 / 1.93)."""
    mesh = Mesh(ridge.vertices, ridge.triangles)
    far = 10 / (1 - 1 / 1.93)
    x = np.array([5.0, 9.5, 10.0, 12.0, far - 0.3, far + 0.3, 25.0, -10.0])
    got = relief(ridge, mesh, pose(1.73), EYE, np.column_stack([x, np.full(len(x), 0.3)]))
    np.testing.assert_array_equal(got.exposed, [True, True, True, False, False, True, True, True])
    np.testing.assert_allclose(got.height, np.maximum(0, 1 - np.abs(x - 10)) - 1.73, atol=1e-6)
    assert (got.kind == Kind.FIELD).all()


def test_height_is_along_the_sensors_own_axis(ridge: Terrain) -> None:
    """On a plane the line along a pitched z axis meets the ground at -(x sin + h) / cos, closed form."""
    pitch, up = 0.2, 1.73
    xy = np.array([[-4.0, 1.0], [-8.0, 2.0], [-2.0, -5.0]])
    got = relief(ridge, Mesh(ridge.vertices, ridge.triangles), pose(up, pitch), EYE, xy)
    want = (xy[:, 0] * np.sin(pitch) - up) / np.cos(pitch)
    np.testing.assert_allclose(got.height, want, atol=1e-6)


def test_height_of_a_point_does_not_depend_on_where_it_is_along_the_axis() -> None:
    rough = build_terrain(
        spec.Terrain(roughness="F", grade=0.1, cell=0.5), [], (-30, -30, 30, 30), np.random.SeedSequence(1)
    )
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(-20, 20, (500, 2)), rng.uniform(-2, 2, 500)])
    higher = points + np.array([0, 0, 3.0])
    T = pose(2.0, 0.1)
    np.testing.assert_allclose(ground_below(rough, T, points), ground_below(rough, T, higher), atol=1e-6)


def test_a_place_that_lies_open_on_rough_ground_is_exposed() -> None:
    """Rays straight down to near places meet nothing first, however rough."""
    rough = build_terrain(
        spec.Terrain(roughness="E", cell=0.5), [], (-30, -30, 30, 30), np.random.SeedSequence(1)
    )
    xy = np.random.default_rng(0).uniform(-3, 3, (200, 2))
    got = relief(rough, Mesh(rough.vertices, rough.triangles), pose(3.0), EYE, xy)
    assert got.exposed.all()
    assert np.isfinite(got.height).all()
