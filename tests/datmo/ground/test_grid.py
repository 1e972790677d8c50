from __future__ import annotations

from collections import defaultdict
from dataclasses import fields

import numpy as np
import pytest

from datmo.bins import bin_edges
from datmo.ground.grid import Candidates, Located, PolarGrid, bin_table, turn_of

GRID = PolarGrid(180, bin_edges())


def cloud(n: int = 3000, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return (rng.uniform(-1, 1, (n, 3)) * [60, 60, 2]).astype(np.float32)


def located(points: np.ndarray, grid: PolarGrid = GRID) -> Located:
    return Located(points, np.ones(len(points), bool), grid)


def test_turn_of_is_arctan2() -> None:
    rng = np.random.default_rng(0)
    xy = rng.normal(size=(20000, 2)) * 10.0 ** rng.uniform(-6, 6, (20000, 1))
    octants = np.array([[x, y] for x in (-1, 0, 1) for y in (-1, 0, 1) if x or y], float)
    xy = np.concatenate([xy, octants, 3e5 * octants, octants * [1, 1e-9], octants * [1e-9, 1]])
    got = np.array([turn_of(x, y) for x, y in xy])
    want = np.arctan2(xy[:, 1], xy[:, 0]) / (2 * np.pi)
    assert ((got >= 0) & (got < 1)).all()
    assert np.abs((got - want + 0.5) % 1.0 - 0.5).max() < 1e-8
    assert turn_of(0.0, 0.0) == 0.0


def test_turn_of_is_exact_on_the_axes() -> None:
    assert [turn_of(x, y) for x, y in ((2.0, 0.0), (0.0, 3.0), (-1.0, 0.0), (0.0, -1.0))] == [
        0.0,
        0.25,
        0.5,
        0.75,
    ]


@pytest.mark.parametrize("edges", [bin_edges(), np.array([2.0, 4.0, 8.0]), np.linspace(0, 30, 400)])
def test_the_table_starts_no_later_than_the_bin(edges: np.ndarray) -> None:
    r = np.random.default_rng(1).uniform(edges[0], edges[-1], 20000)
    table = bin_table(edges)
    bins = np.digitize(r, edges) - 1
    start = table[(r * 32).astype(int)]
    assert (start <= bins).all()
    assert (bins - start).max() <= 1


def test_locate_is_the_definition() -> None:
    points = cloud()
    keep = np.random.default_rng(1).random(len(points)) < 0.9
    at = Located(points, keep, GRID)
    r = np.hypot(points[:, 0].astype(float), points[:, 1].astype(float))
    azimuth = np.degrees(np.arctan2(points[:, 1].astype(float), points[:, 0].astype(float))) % 360
    want = np.floor(azimuth / 2) * 120 + np.digitize(r, GRID.edges) - 1
    inside = keep & (r >= GRID.edges[0]) & (r < GRID.edges[-1])
    assert np.array_equal(at.cell[inside], want[inside])
    assert (at.cell[~inside] == -1).all()
    assert np.allclose(at.radius, r)
    assert np.allclose(at.azimuth, azimuth / 2, atol=1e-5)


def test_edges_are_half_open() -> None:
    grid = PolarGrid(12, np.array([2.0, 4.0, 8.0]))
    points = np.array([[1.999, 0.001, 0], [2, 0, 0], [4, 0, 0], [8, 0, 0]], np.float32)
    assert located(points, grid).cell.tolist() == [-1, 0, 1, -1]


def test_what_is_not_finite_or_far_above_has_no_cell() -> None:
    bad = [[np.nan, 5, 0], [5, np.inf, 0], [5, 5, np.nan], [5, 5, -np.inf], [5, 5, 80.0], [5, 5, -81.0]]
    at = located(np.array([*bad, [5, 5, 79.0]], np.float32))
    assert (at.cell[:-1] == -1).all()
    assert at.cell[-1] >= 0
    assert np.isnan(at.azimuth).tolist() == np.isnan(at.radius).tolist() == [True] * 2 + [False] * 5


def by_cell(points: np.ndarray, multipath: float) -> dict[tuple[int, int], tuple[np.ndarray, float]]:
    """Candidate and extent of each cell, from lists of distinct points."""
    cells: dict[tuple[int, int], list[tuple[float, float, float]]] = defaultdict(list)
    for x, y, z in np.unique(points, axis=0).astype(float):
        r = np.hypot(x, y)
        if GRID.edges[0] <= r < GRID.edges[-1]:
            turn = np.arctan2(y, x) / (2 * np.pi) % 1.0
            cells[int(turn * 180), int(np.digitize(r, GRID.edges)) - 1].append((z, x, y))
    found = {}
    for where, rows in cells.items():
        rows.sort()  # by height, then x, then y
        higher = [row for row in rows if row[0] > rows[0][0]]
        chosen = higher[0] if higher and higher[0][0] - rows[0][0] > multipath else rows[0]
        found[where] = np.array([chosen[1], chosen[2], chosen[0]]), rows[-1][0] - chosen[0]
    return found


def crowd(seed: int) -> np.ndarray:
    """Several points a cell, many of equal height, some of them equal altogether."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (6000, 3)) * [12, 12, 2]
    points[:, 2] = np.round(points[:, 2], 1)
    points = np.concatenate([points, points[::5], points[::7] * [1, 1, 0] + [0, 0, -3.0]])
    return rng.permutation(points).astype(np.float32)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("multipath", [0.25, 1.05, 50.0])
def test_candidates_are_those_of_plain_lists(seed: int, multipath: float) -> None:
    points = crowd(seed)
    got, want = located(points).candidates(multipath), by_cell(points, multipath)
    assert set(zip(*np.nonzero(got.present), strict=True)) == set(want)
    for where, (xyz, extent) in want.items():
        assert np.array_equal([got.x[where], got.y[where], got.z[where]], xyz)
        assert got.extent[where] == pytest.approx(extent, abs=1e-6)
        assert got.r[where] == pytest.approx(np.hypot(*xyz[:2]))
        assert int(got.azimuth[where]) == where[0]


def test_an_empty_cell_has_its_middle() -> None:
    found = located(np.zeros((0, 3), np.float32)).candidates(0.3)
    assert not found.present.any()
    assert np.array_equal(found.r, np.tile(GRID.centers, (180, 1)))
    assert np.array_equal(np.column_stack([found.x.ravel(), found.y.ravel()]), GRID.xy(GRID.centers))
    for height in (found.z, found.extent, found.above(np.array([0.3, 0.1, -2.0]))):
        assert not height.any()


def test_candidate_is_the_lowest_or_the_second_after_a_mirror_image() -> None:
    points = np.array(
        [[5, 0.01, z] for z in (-1.5, -1.7, -1.68)] + [[-5, 0.01, z] for z in (-1.0, -3.0, -1.7)]
    )
    found = located(points.astype(np.float32)).candidates(0.3)
    height = found.above(np.zeros(3))
    assert np.allclose(np.sort(height[found.present]), [-1.7, -1.7])
    assert np.allclose(np.sort(found.extent[found.present]), [0.2, 0.7])


def test_candidates_do_not_depend_on_order_or_copies() -> None:
    points = cloud()
    points[:, 2] = np.round(points[:, 2], 1)  # many equal heights
    shuffled = np.concatenate([points, points[::3]])[np.random.default_rng(5).permutation(4000)]
    one, two = (located(p).candidates(0.3) for p in (points, shuffled))
    for field in fields(Candidates):
        assert np.array_equal(getattr(one, field.name), getattr(two, field.name))
    plane = np.array([0.1, 0.02, -1.0])
    assert np.array_equal(one.above(plane), two.above(plane))
