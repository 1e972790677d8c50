from __future__ import annotations

import numpy as np
import pytest

from datmo.arrays import F64, Array
from datmo.errors import SimulationError
from sim.scan.embree import MISS, Mesh


def nearest_hit(vertices: F64, triangles: Array, origin: F64, direction: F64) -> float:
    """Moeller and Trumbore's ray, one triangle after the other; inf where none is met."""
    best = np.inf
    for a, b, c in vertices[triangles]:
        p = np.cross(direction, c - a)
        det = (b - a) @ p
        if abs(det) < 1e-12:
            continue
        u = (origin - a) @ p / det
        q = np.cross(origin - a, b - a)
        v, t = direction @ q / det, (c - a) @ q / det
        if u >= 0 and v >= 0 and u + v <= 1 and t > 0:
            best = min(best, t)
    return float(best)


def test_cast_agrees_with_moeller_trumbore() -> None:
    rng = np.random.default_rng(4)
    vertices = rng.normal(0, 5, (60, 3)).astype(np.float32)
    triangles = rng.permutation(60).reshape(20, 3).astype(np.int32)
    origins = rng.normal(0, 8, (400, 3)).astype(np.float32)
    directions = rng.normal(0, 1, (400, 3))
    directions = (directions / np.linalg.norm(directions, axis=1)[:, None]).astype(np.float32)
    casts = Mesh(vertices, triangles).cast(origins, directions)
    want = np.array(
        [
            nearest_hit(vertices.astype(float), triangles, o, d)
            for o, d in zip(origins.astype(float), directions.astype(float), strict=True)
        ]
    )
    assert 50 < np.isfinite(want).sum() < 390
    np.testing.assert_array_equal(casts.triangle >= 0, np.isfinite(want))
    hit = np.isfinite(want)
    np.testing.assert_allclose(casts.distance[hit], want[hit], rtol=2e-4)
    assert (casts.distance[~hit] >= MISS * 0.99).all()


def test_cast_of_no_rays_is_empty() -> None:
    mesh = Mesh(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.int32))
    nothing = np.zeros((0, 3), np.float32)
    assert len(mesh.cast(nothing, nothing).distance) == 0


@pytest.mark.parametrize(
    ("vertices", "triangles"),
    [(np.eye(3), np.zeros((0, 3))), (np.full((3, 3), np.nan), [[0, 1, 2]]), (np.eye(3), [[0, 1, 3]])],
)
def test_a_broken_mesh_is_refused(vertices: F64, triangles: F64) -> None:
    with pytest.raises(SimulationError, match="triangle"):
        Mesh(np.asarray(vertices, np.float32), np.asarray(triangles, np.int32))
