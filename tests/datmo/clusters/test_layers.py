"""Layers against lists of heights cut by hand, and what comes apart by height."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.clusters import ClusterConfig, cluster
from datmo.clusters.grid import PolarGrid
from datmo.clusters.layers import BIN, BINS, find_layers, label_points

EDGES = np.array([0.0, 10, 40, 60])
GRID = PolarGrid(EDGES, np.array([3, 4, 2]), np.array([0, 3, 7]))
RING = [0, 0, 0, 1, 1, 1, 1, 2, 2]
SENSOR = 1.73


def bin_of(height, config):
    return min(int((height - config.min_height) / BIN), BINS - 1) if height >= config.min_height else -1


def hangs(b, beneath, config, ring):
    """Whether what begins in bin b hangs free above what ends in the bin `beneath`."""
    gap = np.ceil(max(config.gap, config.gap_growth * EDGES[ring + 1]) / BIN)
    high = config.layers and b * BIN + config.min_height > config.headroom - 1e-9
    return high and b - beneath - 1 >= gap


def cut(bins, config, ring):
    """Lists of bins, from the ground up: a new one where a bin hangs free above the one before."""
    layers = []
    for b in sorted(set(bins)):
        if not layers or hangs(b, layers[-1][-1], config, ring):
            layers.append([])
        layers[-1].append(b)
    return layers


@settings(max_examples=200, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(0, 80),
    st.booleans(),
    st.sampled_from([0.05, 0.3, 1.0, 1e30]),
    st.sampled_from([-1.0, 0.3, 2.0, 9.0, 1e30]),
)
def test_layers_are_those_cut_by_hand(seed, n, layers, gap, headroom):
    rng = np.random.default_rng(seed)
    config = ClusterConfig(layers=layers, gap=gap, headroom=headroom)
    cell = rng.integers(-1, GRID.size, n).astype(np.int32)
    height = rng.choice([rng.uniform(-1, 8, n), np.full(n, 1.0), rng.normal(2.5, 0.4, n)])
    found = find_layers(cell, height, GRID, config)
    mine = []
    for c in range(GRID.size):
        linking = [bin_of(h, config) for h in height[cell == c] if h >= config.min_height]
        mine += [(c, layer) for layer in cut(linking, config, RING[c])]
    assert found.cell.tolist() == [c for c, _ in mine]
    assert found.low.tolist() == [layer[0] for _, layer in mine]
    assert found.high.tolist() == [layer[-1] for _, layer in mine]
    assert found.first.tolist() == [sum(c < k for c, _ in mine) for k in range(GRID.size + 1)]

    label = rng.permutation(len(mine)).astype(np.int32)
    got = label_points(label, found, cell, height, config)
    for i in range(n):
        b = bin_of(height[i], config)
        own = [(k, layer) for k, (c, layer) in enumerate(mine) if c == cell[i]]
        if b >= 0:
            held = [k for k, layer in own if b in layer]
        else:  # a low point is the lowest layer's, unless that hangs
            held = [k for k, layer in own[:1] if not hangs(layer[0], -1, config, RING[cell[i]])]
        assert got[i] == (label[held[0]] if held else -1)


def standing(x, y, top, bottom=0.0, n=30):
    """A column of points (n, 3), heights above flat ground."""
    return np.column_stack([np.full(n, x), np.full(n, y), np.linspace(bottom, top, n)])


def sheet(x, y, height, half=2.0, step=0.15):
    """A level patch of points about (x, y)."""
    u = np.arange(-half, half, step)
    return np.column_stack([*(g.ravel() for g in np.meshgrid(x + u, y + u)), np.full(len(u) ** 2, height)])


def labels(*parts, config=None):
    """Label of each part; its points must share it."""
    points = np.concatenate(parts)
    found = cluster(points - [0, 0, SENSOR], points[:, 2], np.ones(len(points), bool), config)
    each = np.split(found.label, np.cumsum([len(p) for p in parts])[:-1])
    assert all(len(set(label)) == 1 for label in each)
    return [int(label[0]) for label in each]


@pytest.mark.parametrize("distance", [4.0, 12.0, 25.0])
def test_a_person_under_a_tree_comes_apart_from_it(distance):
    person = standing(distance, 0, 1.8)
    trunk = standing(distance, 4, 4.0)
    crown = np.concatenate([sheet(distance, 2, h, half=3.0) for h in np.arange(2.5, 7, 0.2)])
    a, b, c = labels(person, trunk, crown)
    assert a != b
    assert b == c  # a tree is one thing, crown and trunk
    a, b, c = labels(person, trunk, crown, config=ClusterConfig(layers=False, max_height=99))
    assert a == b == c


@pytest.mark.parametrize("distance", [6.0, 15.0, 30.0])
def test_a_car_under_a_bridge_comes_apart_from_it(distance):
    car = np.concatenate([standing(distance, y, 1.5) for y in np.arange(-0.9, 0.9, 0.15)])
    deck = np.concatenate([sheet(distance, 0, h, half=3.0) for h in np.arange(4.5, 9, 0.25)])
    a, b = labels(car, deck)
    assert a != b


def test_a_bridge_far_above_every_bin_is_whole():
    assert labels(np.concatenate([sheet(20, 0, h) for h in (7, 12.0, 40.0)])) == [0]


@pytest.mark.parametrize("distance", [8.0, 30.0, 60.0])
def test_rings_apart_by_range_do_not_tear_what_is_high(distance):
    # a wall of a lorry's height: the rings of an HDL-64 that look upward are a third of a degree apart
    step = np.deg2rad(1 / 3) * distance
    heights = np.arange(0.4, 4.0, step)
    wall = np.concatenate(
        [standing(distance, y, h, h, 1) for h in heights for y in np.arange(-1.2, 1.2, 0.2)]
    )
    labels(wall)


def test_glass_does_not_part_a_roof_from_its_car():
    doors, roof = sheet(12, 0, 0.9, half=0.9), sheet(12, 0, 1.9, half=0.9)
    a, b = labels(doors, roof)
    assert a == b


def test_what_lies_under_a_crown_is_no_part_of_it():
    crown, leaves = labels(sheet(10, 0, 3.0), sheet(10, 0, 0.1))
    assert (crown, leaves) == (0, -1)
    post, kerb = labels(standing(10, 0, 3.0, 0.9), standing(10, 0, 0.1))
    assert post == kerb == 0
