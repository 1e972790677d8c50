from __future__ import annotations

import numpy as np
import pytest
from datmo.ground.coarse import SheetRules, basis, flat_sheet, settle, solve, value

from datmo.bins import bin_edges
from datmo.ground.connectivity import components, connected, readmitted
from datmo.ground.grid import PolarGrid
from datmo.ground.plane import robust_plane
from datmo.ground.seeds import block_lowest

RULES = SheetRules(0.1, 0.25, 2.0, True)


@pytest.mark.parametrize("slope", [0.0, 0.1, np.tan(np.radians(15))])
def test_plane_under_obstacles(slope: float) -> None:
    rng = np.random.default_rng(0)
    xy = rng.uniform(-25, 25, (2000, 2))
    z = slope * xy[:, 0] - 0.5 * slope * xy[:, 1] - 1.7 + rng.normal(0, 0.03, 2000)
    up = rng.random(2000) < 0.4
    z[up] += rng.uniform(0.5, 5, up.sum())
    plane = robust_plane(np.column_stack([xy, z]), -1.73)
    assert np.allclose(plane, [slope, -0.5 * slope, -1.7], atol=0.02)


@pytest.mark.parametrize("n", [0, 1, 2])
def test_plane_of_too_few_points_is_level(n: int) -> None:
    xyz = np.column_stack([np.arange(n), np.zeros(n), np.full(n, -2.0)])
    assert np.allclose(robust_plane(xyz, -1.73), [0, 0, -2.0 if n else -1.73])


def test_sheet_solves_its_normal_equations() -> None:
    """The matrix-free conjugate gradients against a dense solve."""
    rng = np.random.default_rng(1)
    k, cell, n = 9, 4.0, 80
    xy = rng.uniform(-12, 12, (n, 2))
    z, w = rng.normal(size=n), rng.uniform(0.1, 1, n)
    first, wx, wy = basis(xy, cell, k)
    B = np.zeros((n, k, k))
    for i in range(n):
        a, b = divmod(first[i], k)
        B[i, a : a + 4, b : b + 4] = np.outer(wx[i], wy[i])
    B = B.reshape(n, -1)
    D1, D2, eye = np.diff(np.eye(k), axis=0), np.diff(np.eye(k), 2, axis=0), np.eye(k)
    first_d = [np.kron(D1, eye), np.kron(eye, D1)]
    second = [np.kron(D2, eye), np.kron(eye, D2), np.sqrt(2) * np.kron(D1, D1)]
    A = B.T @ (w[:, None] * B) + 0.01 * np.eye(k * k)
    A += 0.3 * sum(d.T @ d for d in second) + 0.05 * sum(d.T @ d for d in first_d)
    c = solve(np.zeros((k, k)), z, w, first, wx, wy, 0.3, 0.05, 0.01, 400)
    want = np.linalg.solve(A, B.T @ (w * z))
    assert np.allclose(c.ravel(), want, atol=1e-7)
    assert np.allclose(value(c, first, wx, wy), B @ want, atol=1e-7)


def test_sheet_passes_under_obstacles_and_follows_hills() -> None:
    rng = np.random.default_rng(2)
    xy = rng.uniform(-50, 50, (8000, 2))
    hill = 0.8 * np.sin(xy[:, 0] / 8)
    z = hill + rng.normal(0, 0.03, 8000)
    up = (np.abs(xy - [12, 5]) < [4, 1.5]).all(1) | (rng.random(8000) < 0.1)
    z[up] += rng.uniform(0.3, 3, up.sum())
    sheet = settle(flat_sheet(80, 4), xy, z, np.ones(8000), RULES, True)
    sheet = settle(sheet, xy, z, np.ones(8000), RULES, False)
    inner = (np.abs(xy) < 45).all(1)
    assert np.sqrt(np.mean((sheet(xy) - hill)[inner] ** 2)) < 0.05
    assert np.abs(sheet(np.array([[12.0, 5.0]])) - 0.8 * np.sin(12 / 8)) < 0.15


def test_block_lowest_takes_one_of_each_block() -> None:
    rng = np.random.default_rng(3)
    height, present = rng.normal(size=(14, 10)), rng.random((14, 10)) < 0.5
    best = block_lowest(height, present, 3)
    assert not (best & ~present).any()
    for a in range(0, 14, 3):
        for b in range(0, 10, 3):
            block = present[a : a + 3, b : b + 3]
            assert best[a : a + 3, b : b + 3].sum() == min(block.sum(), 1)
            if block.any():
                low = np.where(present, height, np.inf)[a : a + 3, b : b + 3].min()
                assert height[a : a + 3, b : b + 3][best[a : a + 3, b : b + 3]] == low


def test_a_roof_is_not_connected_and_a_terrace_is_readmitted() -> None:
    grid = PolarGrid(180, bin_edges())
    r = np.tile(grid.centers, (180, 1))
    e = np.zeros(grid.shape)
    e[20:24, 60:64] = 0.45  # the size of a car's floor
    e[90:120, 70:100] = 0.45  # a terrace
    low = np.ones(grid.shape, bool)
    label = components(r, np.where(low, e, 0), low)
    steps = np.unique(label)
    kept = connected(r, label)
    back = readmitted(label, kept, e, grid.areas)
    assert len(steps) >= 3
    assert kept[0, 0]
    assert not kept[22, 62]
    assert not back[22, 62]
    assert not kept[100, 80]
    assert back[100, 80]
