"""The fast paths of the surface over points and cells against its plain call."""

from __future__ import annotations

import numpy as np

from datmo.bins import bin_edges
from datmo.ground.grid import Located, PolarGrid
from datmo.ground.label import POINTS, cell_means
from datmo.ground.surface import PolarSurface, at_cells, gaps

GRID = PolarGrid(180, bin_edges())
RNG = np.random.default_rng(0)
SURFACE = PolarSurface(
    np.array([0.1, -0.05, -1.7]),
    GRID.nodes,
    RNG.normal(0, 0.3, (180, len(GRID.nodes))),
    RNG.uniform(0.01, 0.5, (180, len(GRID.nodes))),
)


def cloud() -> np.ndarray:
    """Everywhere: at nodes and edges, at the sensor, beyond the grid, high above, not finite."""
    points = np.random.default_rng(1).uniform(-1, 1, (5000, 3)) * [100, 100, 3]
    edges = np.column_stack([GRID.edges, np.zeros(121), np.zeros(121)])
    middles = np.column_stack([np.zeros(120), -GRID.centers, np.ones(120)])
    odd = [[0, 0, 0], [1e-9, 0, 1], [0.5, -0.5, 1], [500, 3, 0], [30, 4, 1e4], [-30, 0, -1], [9, 9, -np.inf]]
    bad = [[np.nan, 1, 1], [1, np.inf, 1], [np.nan] * 3]
    return np.concatenate([points, edges, middles, odd, bad]).astype(np.float32)


def test_points_have_the_surface_of_the_call() -> None:
    points = cloud()
    keep = np.random.default_rng(2).random(len(points)) < 0.8
    over, std = SURFACE.below_with_std(Located(points, keep, GRID))
    mean, deviation = SURFACE(points[:, :2].astype(float))
    finite = np.isfinite(points[:, :2]).all(1)
    assert np.allclose(over[finite], points[finite, 2] - mean[finite], atol=1e-5)
    assert np.allclose(std[finite], deviation[finite], rtol=1e-5, atol=1e-6)
    assert np.isnan(over[~finite]).all()
    assert np.isnan(std[~finite]).all()


def test_heights_alone_are_the_same() -> None:
    located = Located(cloud(), np.ones(len(cloud()), bool), GRID)
    assert np.array_equal(SURFACE.below(located), SURFACE.below_with_std(located)[0], equal_nan=True)


def test_cells_have_the_surface_of_the_call() -> None:
    rng = np.random.default_rng(3)
    azimuth = np.arange(180)[:, None] + rng.uniform(0.001, 0.999, GRID.shape)
    radius = rng.uniform(GRID.edges[:-1], GRID.edges[1:], GRID.shape)
    angle = azimuth * 2 * np.pi / 180
    xy = np.stack([radius * np.cos(angle), radius * np.sin(angle)], -1).reshape(-1, 2)
    level = PolarSurface(np.zeros(3), SURFACE.nodes, SURFACE.mean, SURFACE.std)
    got = at_cells(SURFACE.mean, SURFACE.nodes, azimuth, radius)
    assert np.allclose(got.ravel(), level(xy)[0], atol=1e-9)


def test_deviation_beyond_the_last_node_grows_by_a_tenth() -> None:
    mean, std = SURFACE(np.array([[80.0, 3.0], [180.0, 0.0]]))
    last = np.mean(SURFACE.std[[0, -1], -1])
    assert np.isclose(std[1], np.hypot(last, 10.0), rtol=1e-12)
    assert np.isfinite(mean).all()


def test_gaps_are_near_the_distance_to_what_is_seen() -> None:
    """Along range and arc in turn: never less than the straight way, at most about its sum of legs."""
    seen = np.random.default_rng(4).random(GRID.shape) < 0.02
    got = gaps(seen, GRID.centers, GRID.nodes)
    at = GRID.xy(GRID.centers)[seen.ravel()]
    nodes = GRID.xy(GRID.nodes)
    straight = np.sqrt(((nodes[:, None] - at) ** 2).sum(2).min(1)).reshape(got.shape)
    assert (got >= straight - 1e-9).all()
    assert (got[:, 1:-1][seen] == 0).all()
    assert np.median(got / np.maximum(straight, 1e-9)) < 1.5


def test_without_anything_seen_the_gap_is_endless() -> None:
    assert np.isinf(gaps(np.zeros(GRID.shape, bool), GRID.centers, GRID.nodes)).all()


def test_cell_means_are_those_of_plain_lists() -> None:
    rng = np.random.default_rng(5)
    points = (rng.uniform(-1, 1, (4000, 3)) * [8, 8, 1]).astype(np.float32)
    located = Located(points, rng.random(4000) < 0.9, GRID)
    e, ground = rng.normal(0, 0.1, 4000), (rng.random(4000) < 0.7) & (located.cell >= 0)
    means = cell_means(located, e, ground, 1e-6)
    scatter, count = np.zeros(120), np.zeros(120)
    for c in range(180 * 120):
        rows, where = np.flatnonzero(ground & (located.cell == c)), divmod(c, 120)
        assert means.use[where] == (len(rows) > 0)
        if len(rows):
            assert abs(means.over[where] - e[rows].mean()) < 2e-6
            assert abs(means.r[where] - located.radius[rows].mean()) < 2e-6
            assert abs(means.azimuth[where] - located.azimuth[rows].mean()) < 2e-6
            scatter[where[1]] += len(rows) * e[rows].var()
            count[where[1]] += len(rows)
        else:
            assert means.over[where] == 0
            assert means.r[where] == GRID.centers[where[1]]
    want = scatter / np.maximum(count, 1) / POINTS + 1e-6
    assert np.allclose(means.noise, np.broadcast_to(want, (180, 120)), atol=2e-6)


def test_cell_means_do_not_depend_on_order() -> None:
    rng = np.random.default_rng(6)
    points = (rng.uniform(-1, 1, (4000, 3)) * [8, 8, 1]).astype(np.float32)
    e, ground, order = rng.normal(0, 0.1, 4000), rng.random(4000) < 0.7, rng.permutation(4000)
    keep = np.ones(4000, bool)
    ground &= Located(points, keep, GRID).cell >= 0
    one = cell_means(Located(points, keep, GRID), e, ground, 1e-6)
    two = cell_means(Located(points[order], keep, GRID), e[order], ground[order], 1e-6)
    for name in ("use", "over", "r", "azimuth", "noise"):
        assert np.array_equal(getattr(one, name), getattr(two, name))
