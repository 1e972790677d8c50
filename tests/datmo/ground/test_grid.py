from __future__ import annotations

import numpy as np

from datmo.bins import bin_edges
from datmo.ground.grid import PolarGrid, candidates, locate

GRID = PolarGrid(180, bin_edges())
LEVEL = np.zeros(3)


def cloud(n: int = 3000, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return (rng.uniform(-1, 1, (n, 3)) * [60, 60, 2]).astype(np.float32)


def test_locate_is_the_definition() -> None:
    points = cloud()
    keep = np.random.default_rng(1).random(len(points)) < 0.9
    cell, _, radius = locate(points, keep, GRID.edges, 180)
    r = np.hypot(points[:, 0].astype(float), points[:, 1].astype(float))
    azimuth = np.degrees(np.arctan2(points[:, 1].astype(float), points[:, 0].astype(float))) % 360
    want = np.floor(azimuth / 2) * 120 + np.digitize(r, GRID.edges) - 1
    inside = keep & (r >= GRID.edges[0]) & (r < GRID.edges[-1])
    assert np.array_equal(cell[inside], want[inside])
    assert (cell[~inside] == -1).all()
    assert np.allclose(radius, r)


def test_edges_are_half_open() -> None:
    edges = np.array([2.0, 4.0, 8.0])
    points = np.array([[1.999, 0.001, 0], [2, 0, 0], [4, 0, 0], [8, 0, 0]], np.float32)
    cell = locate(points, np.ones(4, bool), edges, 12)[0]
    assert cell.tolist() == [-1, 0, 1, -1]


def test_candidate_is_the_lowest_or_the_second_after_a_mirror_image() -> None:
    points = np.array(
        [[5, 0.01, z] for z in (-1.5, -1.7, -1.68)] + [[-5, 0.01, z] for z in (-1.0, -3.0, -1.7)]
    )
    points = points.astype(np.float32)
    cell, _, radius = locate(points, np.ones(6, bool), GRID.edges, 180)
    found = candidates(points, cell, radius, LEVEL, GRID, 0.3)
    assert np.allclose(np.sort(found.height[found.present]), [-1.7, -1.7])
    assert np.allclose(np.sort(found.extent[found.present]), [0.2, 0.7])


def test_candidates_do_not_depend_on_order_or_copies() -> None:
    points = cloud()
    points[:, 2] = np.round(points[:, 2], 1)  # many equal heights
    shuffled = np.concatenate([points, points[::3]])[np.random.default_rng(5).permutation(4000)]
    results = []
    for p in (points, shuffled):
        cell, _, radius = locate(p, np.ones(len(p), bool), GRID.edges, 180)
        results.append(candidates(p, cell, radius, np.array([0.1, 0.02, -1.0]), GRID, 0.3))
    for name in ("present", "xyz", "r", "height", "extent"):
        assert np.array_equal(getattr(results[0], name), getattr(results[1], name))
