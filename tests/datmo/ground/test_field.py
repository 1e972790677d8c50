"""The field of `default`: what it learns of simulated Brownian ground, and how honest it is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from datmo.bins import bin_edges
from datmo.ground import GroundConfig, segment_ground
from datmo.ground.chebyshev import weights
from datmo.ground.field import Field, conductance, roughness
from datmo.ground.grid import PolarGrid
from datmo.ground.membrane import links, settle
from datmo.ground.regression import Cells

Make = Callable[..., Any]
GRID = PolarGrid(12, np.array([2.0, 2.5, 3.4, 4.0, 5.5, 6.1, 8.0, 10.5, 11.0, 14.0]))
M, N = GRID.shape
R = GRID.centers


def test_fit_is_near_the_dense_solution() -> None:
    """The few turns of a frame, from the observations: a fifth of the field's own deviation off."""
    grid, rng = PolarGrid(36, bin_edges(40, radius=40.0)), np.random.default_rng(2)
    y = np.cumsum(rng.normal(0, 0.02, grid.shape), 1)
    use, noise = rng.random(grid.shape) < 0.7, np.full(grid.shape, 0.01**2)
    method = Field(grid, GroundConfig())
    heights, learned = method.fit(Cells(np.tile(grid.centers, (36, 1)), y, use, noise=noise), method.start())
    f = np.where(use, y, 0.0)
    c, frame = roughness(f, use, noise, grid.centers, 1e-3)
    assert learned.hyper["c"] == frame
    observed = f.copy()
    w = np.where(use, 1 / (noise + 0.04 * c * np.sqrt(grid.areas)), 0.0)
    settle(f, w, observed, *links(c, grid.centers), 1.0, weights(1000, 1e-4, 2.0))
    off = np.abs(heights.mean[:, 1:-1] - f) / np.sqrt(heights.var[:, 1:-1])
    assert np.median(off) < 0.2
    assert np.quantile(off, 0.95) < 1.0


def brownian(grid: PolarGrid, c: float, rng: np.random.Generator) -> np.ndarray:
    """(M, N) of Lévy's Brownian field, E[(z(p) - z(q))²] = c |p - q|."""
    xy = grid.xy(grid.centers)
    norm = np.hypot(xy[:, 0], xy[:, 1])
    apart = np.hypot(*(xy[:, None] - xy).transpose(2, 0, 1))
    K = c / 2 * (norm[:, None] + norm - apart)
    return np.asarray((np.linalg.cholesky(K) @ rng.normal(size=len(xy))).reshape(grid.shape))


@pytest.mark.parametrize("c", [1e-4, 1e-3, 4e-3])
def test_roughness_of_brownian_ground_is_recovered(c: float) -> None:
    grid, rng = PolarGrid(60, bin_edges(24, radius=40.0)), np.random.default_rng(3)
    z, noise = brownian(grid, c, rng), np.full(grid.shape, 0.01**2)
    z = z + rng.normal(0, 0.01, grid.shape)
    use = rng.random(grid.shape) < 0.8
    local, frame = roughness(np.where(use, z, 99.0), use, noise, grid.centers, 1.0)
    assert frame == pytest.approx(c, rel=0.2)
    assert np.median(local) == pytest.approx(c, rel=0.2)


def test_roughness_is_local() -> None:
    """A rough half beside a smooth one."""
    grid, rng = PolarGrid(60, bin_edges(24, radius=40.0)), np.random.default_rng(4)
    z = brownian(grid, 1e-3, rng)
    z[30:] *= 3
    use, none = np.ones(grid.shape, bool), np.zeros(grid.shape)
    local, frame = roughness(z, use, none, grid.centers, 1.0)
    smooth, rough = np.median(local[5:25]), np.median(local[35:55])
    assert smooth == pytest.approx(1e-3, rel=0.35)
    assert rough == pytest.approx(9e-3, rel=0.35)
    assert smooth < frame < rough


def test_roughness_without_a_pair_is_the_start() -> None:
    use = np.zeros((M, N), bool)
    use[3, 4] = True
    local, frame = roughness(np.ones((M, N)), use, np.zeros((M, N)), R, 2e-3)
    assert frame == 2e-3
    assert np.allclose(local, 2e-3)


def test_roughness_of_flat_ground_stays_positive() -> None:
    local, frame = roughness(np.zeros((M, N)), np.ones((M, N), bool), np.full((M, N), 1e-4), R, 1.0)
    assert 0 < frame < 1e-6
    assert (local > 0).all()


def test_conductance_is_the_sum_over_the_nearest_used_cells() -> None:
    use = np.random.default_rng(8).random((M, N)) < 0.4
    use[:, 2], use[:2, 5] = False, True  # a ring without any; the others have two or more
    assert (use.sum(0) >= 2).sum() == N - 1
    want = np.zeros((M, N))
    for m in range(M):
        for b in range(N):
            inward = [R[b] - R[k] for k in range(b) if use[m, k]]
            outward = [R[k] - R[b] for k in range(b + 1, N) if use[m, k]]
            left = [k * 2 * np.pi / M * R[b] for k in range(1, M) if use[(m + k) % M, b]]
            right = [k * 2 * np.pi / M * R[b] for k in range(1, M) if use[(m - k) % M, b]]
            want[m, b] = sum(1 / min(way) for way in (inward, outward, left, right) if way)
    assert np.allclose(conductance(use, R), want, rtol=1e-12)


@pytest.mark.parametrize("roughness_class", ["C", "E", "G"])
def test_deviation_is_honest_at_seen_and_unseen_centres(scene: Make, roughness_class: str) -> None:
    """coverage95 at the centres of the grid's cells that hold ground returns, and that hold none."""
    grid, inside = PolarGrid(180, bin_edges()), {True: [], False: []}
    for seed in (40, 41):
        sweep = scene(roughness_class, 0.05, seed=seed)
        xy = grid.xy(grid.centers)
        near = np.hypot(xy[:, 0], xy[:, 1]) < 40
        seen = np.zeros(len(xy), bool)
        p = sweep.points[sweep.is_ground].astype(float)
        r = np.hypot(p[:, 0], p[:, 1])
        turn = (np.arctan2(p[:, 1], p[:, 0]) / (2 * np.pi) % 1.0 * 180).astype(int) % 180
        held = (r >= 2) & (r < 80)
        seen[turn[held] * 120 + np.digitize(r[held], grid.edges) - 1] = True
        mean, std = segment_ground(sweep.points, "default").surface(xy)
        error = mean - sweep.true_height(xy)
        for which in (True, False):
            rows = near & (seen == which)
            inside[which].append(np.abs(error[rows]) <= 1.96 * std[rows])
    for which, parts in inside.items():
        hits = np.concatenate(parts)
        assert len(hits) > 1000
        most = 0.99 if which else 0.995  # what is unseen may be more than told
        assert 0.90 <= hits.mean() <= most, f"{'seen' if which else 'unseen'}: {hits.mean():.3f}"
