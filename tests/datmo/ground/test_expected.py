from __future__ import annotations

import numpy as np
import pytest

from datmo.bins import bin_edges
from datmo.ground import GroundConfig
from datmo.ground.connectivity import components, connected, readmitted
from datmo.ground.grid import Located, PolarGrid
from datmo.ground.plane import robust_plane
from datmo.ground.seeds import Expected, GroundExpectation, block_lowest

GRID = PolarGrid(180, bin_edges())


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
    r = np.tile(GRID.centers, (180, 1))
    e = np.zeros(GRID.shape)
    e[20:24, 60:64] = 0.45  # the size of a car's floor
    e[90:120, 70:100] = 0.45  # a terrace
    low = np.ones(GRID.shape, bool)
    label = components(r, e, e, low)
    kept = connected(r, label, GRID.areas)
    back = readmitted(label, kept, e, GRID.areas)
    assert len(np.unique(label)) >= 3
    assert kept[0, 0]
    assert not kept[22, 62]
    assert not back[22, 62]
    assert not kept[100, 80]
    assert back[100, 80]


def slow_components(r: np.ndarray, e: np.ndarray, z: np.ndarray, low: np.ndarray) -> np.ndarray:
    """By flooding: the next low cell outwards within reach; in the next segment two bins off at most."""
    M, N = r.shape
    links: dict[tuple[int, int], list[tuple[int, int]]] = {(m, b): [] for m in range(M) for b in range(N)}

    def link(one: tuple[int, int], two: tuple[int, int], d: float) -> None:
        most = 0.15 + 0.35 * d
        if abs(z[one] - z[two]) <= most and abs(e[one] - e[two]) <= min(most, 0.3):
            links[one].append(two)
            links[two].append(one)

    for m, b in zip(*np.nonzero(low), strict=True):
        outwards = np.flatnonzero(low[m, b + 1 :])
        if len(outwards):
            far = (m, b + 1 + outwards[0])
            if r[far] - r[m, b] <= 1 + 0.2 * r[far]:
                link((m, b), far, r[far] - r[m, b])
        o = (m + 1) % M
        for c in range(max(b - 2, 0), min(b + 3, N)):
            if low[o, c]:
                link((m, b), (o, c), np.hypot(r[m, b] - r[o, c], 2 * np.pi / M * r[m, b]))
    label = np.full((M, N), -1)
    for m, b in zip(*np.nonzero(low), strict=True):
        if label[m, b] < 0:
            label[m, b], stack = m * N + b, [(m, b)]
            while stack:
                for other in links[stack.pop()]:
                    if label[other] < 0:
                        label[other] = m * N + b
                        stack.append(other)
    return label


@pytest.mark.parametrize("seed", range(4))
def test_components_are_those_of_flooding(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = 24, 30
    r = np.sort(rng.uniform(2, 40, shape), 1)
    e = rng.normal(0, 0.25, shape)
    z = e + rng.normal(0, 0.4, (24, 1))
    low = rng.random(shape) < 0.6
    got = components(r, e, z, low)
    assert np.array_equal(got, slow_components(r, e, z, low))
    assert len(np.unique(got)) > 10


def test_a_step_of_the_ground_itself_parts_what_the_sheet_hides() -> None:
    """A sheet drawn up a wall leaves no step over it; the height over the plane still has it."""
    r = np.tile(GRID.centers, (180, 1))
    low, z = np.ones(GRID.shape, bool), np.zeros(GRID.shape)
    z[:, 60:] = 1.0
    assert len(np.unique(components(r, np.zeros_like(z), z, low))) == 2
    assert len(np.unique(components(r, np.zeros_like(z), 0 * z, low))) == 1


def test_without_a_large_component_near_the_largest_is_the_ground() -> None:
    label = np.full(GRID.shape, -1, np.int32)
    label[10:12, 80:82], label[50:54, 100:104] = 7, 9
    kept = connected(np.tile(GRID.centers, (180, 1)), label, GRID.areas)
    assert np.array_equal(kept, label == 9)
    none = np.full(GRID.shape, -1, np.int32)
    assert not connected(np.tile(GRID.centers, (180, 1)), none, GRID.areas).any()


def test_what_lies_on_the_surface_is_readmitted() -> None:
    label, e = np.full(GRID.shape, -1, np.int32), np.zeros(GRID.shape)
    label[10:12, 40:42], label[50:52, 40:42], label[90:92, 40:42] = 1, 2, 3
    e[50:52, 40:42] = 0.4
    e[90, 40:42], e[91, 40:42] = 0.1, 0.4  # half of it, not most
    back = readmitted(label, np.zeros(GRID.shape, bool), e, GRID.areas)
    assert np.array_equal(back, label == 1)


def expected(z: np.ndarray, config: GroundConfig | None = None) -> Expected:
    """The expected ground of one point in the middle of each cell, heights z (M, N), NaN without."""
    xy = GRID.xy(GRID.centers)
    points = np.column_stack([xy, z.ravel()]).astype(np.float32)[np.isfinite(z).ravel()]
    cells = Located(points, np.ones(len(points), bool), GRID).candidates(0.3)
    return GroundExpectation(GRID, config or GroundConfig())(cells, np.array([0.0, 0.0, -1.73]))


def height(found: Expected, xy: np.ndarray) -> np.ndarray:
    azimuth = np.arctan2(xy[:, 1], xy[:, 0]) / (2 * np.pi) % 1.0 * 180
    return np.asarray(found.sheet.at(azimuth, np.hypot(xy[:, 0], xy[:, 1]), 180))


def test_expected_ground_of_hills_is_the_hills() -> None:
    xy = GRID.xy(GRID.centers)
    hill = 0.6 * np.sin(2 * np.pi * xy[:, 0] / 20)
    found = expected((hill - 1.73).reshape(GRID.shape))
    near = np.hypot(xy[:, 0], xy[:, 1]) < 40
    assert np.sqrt(np.mean((height(found, xy) - hill)[near] ** 2)) < 0.06
    inside = GRID.centers < 40
    assert found.usable[:, inside].mean() > 0.999
    assert found.seed[:, inside].mean() > 0.98
    assert np.allclose(found.e.ravel()[near], (hill - height(found, xy))[near], atol=1e-5)


def test_a_car_with_nothing_behind_it_does_not_carry_the_expected_ground() -> None:
    """Its side 3 m off takes all cells there; beyond it nothing is seen."""
    z = np.full(GRID.shape, -1.73)
    beside = slice(35, 56)  # 42 degrees to the left
    r = GRID.centers
    z[beside, (r > 2.9) & (r < 4.6)] = -1.1
    z[beside, r >= 4.6] = np.nan
    found = expected(z)
    assert not found.usable[beside, (r > 2.9) & (r < 4.6)].any()
    assert not found.seed[beside, (r > 2.9) & (r < 4.6)].any()
    a = GRID.angles[beside]
    for d in (3.2, 3.7, 4.3, 8.0, 15.0):
        assert np.abs(height(found, d * np.column_stack([np.cos(a), np.sin(a)]))).max() < 0.1


def test_without_the_coarse_sheet_the_plane_is_expected() -> None:
    found = expected(np.full(GRID.shape, -1.5), GroundConfig(coarse=False))
    assert not found.sheet.f.any()
    assert np.allclose(found.e, 0.23)
