"""Connected components against a flood fill written down plainly."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.clusters.config import ClusterConfig
from datmo.clusters.connect import connect_plain, connect_polar
from datmo.clusters.grid import PolarGrid, polar_grid
from datmo.clusters.layers import BIN, find_layers


def flood_fill(occupied, neighbours):
    """Alg. 8, corrected: the search goes on from the neighbour."""
    label = {}
    count = 0
    for start in sorted(occupied):
        if start in label:
            continue
        stack = [start]
        label[start] = count
        while stack:
            cell = stack.pop()
            for other in neighbours(cell):
                if other in occupied and other not in label:
                    label[other] = count
                    stack.append(other)
        count += 1
    return label


def touching(grid):
    """Neighbours of each flat cell: closed intervals of azimuth that meet, in rings that meet."""
    where = [
        (r, Fraction(j, int(n)), Fraction(j + 1, int(n)))
        for r, n in enumerate(grid.columns)
        for j in range(n)
    ]

    def meet(a, b):
        if abs(a[0] - b[0]) > 1:
            return False
        return any(a[1] <= b[2] + turn and b[1] + turn <= a[2] for turn in (-1, 0, 1))

    return [[j for j, b in enumerate(where) if i != j and meet(a, b)] for i, a in enumerate(where)]


def small_grid(columns):
    columns = np.array(columns)
    return PolarGrid(np.arange(len(columns) + 1.0), columns, np.cumsum(columns) - columns)


GRIDS = [small_grid(c) for c in ([3, 7, 7, 12, 12], [1, 1, 4, 9, 16], [2, 5, 31], [9, 8, 8, 3])]
NEIGHBOURS = [touching(g) for g in GRIDS]
HEADROOM = 17  # the bin that begins 2.0 m above the ground, where bin 0 begins at 0.3 m


def apart(above, below):
    """Whether a layer (lowest bin, highest bin, gap) hangs free above another one."""
    return above[0] >= HEADROOM and above[0] - below[1] - 1 >= above[2]


@settings(max_examples=150, deadline=None)
@given(st.integers(0, len(GRIDS) - 1), st.integers(0, 2**32 - 1), st.floats(0.05, 2.5), st.booleans())
def test_polar_components_are_those_of_a_flood_fill(which, seed, share, layers):
    grid, rng = GRIDS[which], np.random.default_rng(seed)
    config = ClusterConfig(gap=0.3, gap_growth=0.15, headroom=2.0, layers=layers)
    cell = rng.integers(0, grid.size, int(share * grid.size)).astype(np.int32)
    found = find_layers(cell, rng.uniform(0.3, 7, len(cell)), grid, config)
    ring = np.searchsorted(grid.first, found.cell, side="right") - 1
    gap = np.ceil(np.maximum(0.3, 0.15 * grid.edges[ring + 1]) / BIN)
    span = list(zip(found.low, found.high, gap, strict=True))
    own = [range(found.first[c], found.first[c + 1]) for c in range(grid.size)]

    def neighbours(k):
        beside = (other for c in NEIGHBOURS[which][found.cell[k]] for other in own[c])
        return [j for j in beside if not (layers and (apart(span[k], span[j]) or apart(span[j], span[k])))]

    expected = flood_fill(set(range(len(span))), neighbours)
    assert connect_polar(found, grid).tolist() == [expected[k] for k in range(len(span))]


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 2**32 - 1), st.floats(0, 1))
def test_plain_components_are_those_of_a_flood_fill(m, n, seed, share):
    occupied = np.random.default_rng(seed).random((m, n)) < share
    steps = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]
    expected = flood_fill(
        set(map(tuple, np.argwhere(occupied).tolist())), lambda c: [(c[0] + i, c[1] + j) for i, j in steps]
    )
    got = connect_plain(occupied)
    assert all(got[i, j] == expected.get((i, j), -1) for i in range(m) for j in range(n))


def test_locate_follows_the_definition():
    config = ClusterConfig(cell=0.25, growth_along=0.02, growth_across=0.01, max_range=60)
    grid = polar_grid(config)
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.uniform(-50, 50, (400, 2)), rng.normal(size=400)])
    taken = rng.random(400) < 0.9
    for flat, (x, y, _), use in zip(grid.locate(points, taken), points, taken, strict=True):
        r = np.hypot(x, y)
        if not use or r >= 60:
            assert flat == -1
            continue
        ring = max(i for i, edge in enumerate(grid.edges) if edge <= r)
        column = int((np.arctan2(y, x) + np.pi) / (2 * np.pi) * grid.columns[ring])
        assert flat == grid.columns[:ring].sum() + column


@pytest.mark.parametrize(
    "config", [ClusterConfig(), ClusterConfig(cell=0.4, growth_along=0.05, max_range=30)]
)
def test_cells_have_the_size_that_the_configuration_says(config):
    grid = polar_grid(config)
    inner, outer = grid.edges[:-1], grid.edges[1:]
    expected = np.maximum(config.cell, config.growth_along * inner)
    np.testing.assert_allclose((outer - inner)[:-1], expected[:-1])  # the last ring is cut at max_range
    assert grid.edges[-1] == config.max_range
    middle = (inner + outer) / 2
    width = 2 * np.pi * middle / grid.columns
    least = np.maximum(config.cell, config.growth_across * middle)
    assert np.all(width >= least * (1 - 1e-12))
    assert np.all(width[20:] <= least[20:] * 1.02)
