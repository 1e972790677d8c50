"""What holds together and what comes apart."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.clusters import ClusterConfig, cluster
from datmo.errors import MessageError

SENSOR = 1.73
CONFIGS = [ClusterConfig(), ClusterConfig(layers=False), ClusterConfig(grid="plain")]
AZIMUTH = np.deg2rad(0.173)
ELEVATIONS = np.deg2rad(np.concatenate([np.linspace(2, -8.3, 32), np.linspace(-8.9, -24.3, 32)]))


def see(boxes, noise=0.0, seed=0):
    """Returns (n, 3) of an HDL-64 from solid boxes x0, x1, y0, y1, z0, z1, heights above flat ground."""
    azimuth, elevation = np.meshgrid(np.arange(-np.pi, np.pi, AZIMUTH), ELEVATIONS)
    ray = np.stack(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], -1
    )
    ray = ray.reshape(-1, 3)
    depth = np.full(len(ray), np.inf)
    for box in np.asarray(boxes, float).reshape(-1, 3, 2):
        low, high = box[:, 0] - [0, 0, SENSOR], box[:, 1] - [0, 0, SENSOR]
        with np.errstate(divide="ignore"):
            a, b = low / ray, high / ray
        near, far = np.minimum(a, b).max(1), np.maximum(a, b).min(1)
        hit = (near <= far) & (near > 0)
        depth[hit] = np.minimum(depth[hit], near[hit])
    seen = np.isfinite(depth)
    depth = depth[seen] + noise * np.random.default_rng(seed).normal(size=seen.sum())
    return ray[seen] * depth[:, None]


def labels(points, config=None):
    found = cluster(points, points[:, 2] + SENSOR, np.ones(len(points), bool), config)
    return found.label, found.count


def car(x, y):
    """Bonnet, windscreen, roof and boot in steps, heading along -x."""
    front, back = [0.0, 0.35, 0.7, 1.0, 1.3, 1.6], [4.4, 4.4, 4.4, 3.9, 3.5, 3.2]
    height = [0.2, 0.72, 0.8, 0.9, 1.15, 1.35, 1.45]
    return [[x + front[i], x + back[i], y, y + 1.8, height[i], height[i + 1]] for i in range(len(front))]


@pytest.mark.parametrize("angle", np.linspace(0, 2 * np.pi, 9))
def test_two_persons_side_by_side_come_apart_at_10_m(angle):
    # 0.6 m of air between them, side by side or one behind the other, is at least two cells
    for gap in ([0.0, 0.6], [0.6, 0.0]):
        a = np.random.default_rng(0).uniform([-0.2, -0.2, 0], [0.2, 0.2, 1.7], (300, 3))
        b = a + np.array([gap[0] + 0.4 * (gap[0] > 0), gap[1] + 0.4 * (gap[1] > 0), 0])
        c, s = np.cos(angle), np.sin(angle)
        points = (np.concatenate([a, b]) + np.array([10, 0, -SENSOR])) @ np.array(
            [[c, s, 0], [-s, c, 0], [0, 0, 1]]
        )
        label, _ = labels(points)
        assert not set(label[:300]) & set(label[300:])


@pytest.mark.parametrize("x", [5, 12, 25, 40, 55])
@pytest.mark.parametrize("y", [-12, -5, -0.9, 3, 8])
def test_a_car_stays_whole(x, y):
    points = see(car(x, y), noise=0.01)
    label, _ = labels(points)
    high = points[:, 2] + SENSOR >= 0.3
    assert len(points) > 20
    share = np.bincount(label[high]) / high.sum()
    assert share.max() >= 0.8  # far away a line of roof points may stand alone


@pytest.mark.parametrize(("x", "y"), [(8, 3), (-5, 12), (20, -5), (30, -1), (50, -8)])
@pytest.mark.parametrize("sill", [2.0, 2.3, 2.5])
def test_layers_do_not_tear_a_bus_with_windows_all_round(x, y, sill):
    # the glass below the roof's sill returns nothing; pillars hold the roof
    body = [[x, x + 12, y, y + 2.55, low, high] for low, high in ((0.3, 1.1), (sill, 3.1))]
    pillars = [
        [x + u, x + u + 0.15, y + v, y + v + 0.15, 1.1, sill]
        for u in (0, 2.4, 4.8, 7.2, 9.6, 11.85)
        for v in (0, 2.4)
    ]
    points = see([*body, *pillars], noise=0.01)
    largest = [np.bincount(labels(points, c)[0] + 1)[1:].max() for c in CONFIGS[:2]]
    assert largest[0] >= largest[1] - 0.05 * len(points)


def test_a_kerb_does_not_link_and_takes_the_label_of_its_cell():
    ends = np.array([[8.0, 2, 1.0], [14, 2, 1.0]])
    kerb = np.column_stack([np.arange(8, 14, 0.05), np.full(120, 2.0), np.full(120, 0.12)])
    points = np.concatenate([ends, kerb]) - [0, 0, SENSOR]
    label, count = labels(points)
    assert count == 2
    assert label[0] != label[1]
    assert label[2] == label[0]
    assert label[60] == -1


@pytest.mark.parametrize(
    "config", [ClusterConfig(), ClusterConfig(layers=False), ClusterConfig(grid="plain", layers=True)]
)
def test_what_hangs_above_links_nothing(config):
    person = np.column_stack([np.full(20, 10.0), np.zeros(20), np.linspace(0.3, 1.8, 20)])
    trunk = person + np.array([0, 4, 0])
    crown = np.column_stack([np.full(200, 10.0), np.linspace(-1, 5, 200), np.full(200, 3.8)])
    label, count = labels(np.concatenate([person, trunk, crown]) - [0, 0, SENSOR], config)
    in_layers = config.layers and config.grid == "polar"
    assert count == (3 if in_layers else 2)
    assert len(set(label[40:])) == 1
    assert not set(label[:40]) & set(label[40:])
    assert (label[40] == -1) == (not in_layers)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(CONFIGS), st.integers(0, 600))
def test_the_order_of_points_does_not_matter(seed, config, n):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(n, 3)) * [20, 20, 2]
    height, elevated = points[:, 2] + 1, rng.random(n) < 0.8
    order = rng.permutation(n)
    a = cluster(points, height, elevated, config)
    b = cluster(points[order], height[order], elevated[order], config)
    assert np.array_equal(a.label[order], b.label)
    assert set(a.label[a.label >= 0]) == set(range(a.count))
    assert np.all(a.label[~elevated] == -1)


@pytest.mark.parametrize("config", CONFIGS)
def test_degenerate_clouds(config):
    assert labels(np.zeros((0, 3)), config)[1] == 0
    assert labels(np.array([[5.0, 0, 0]]), config)[0].tolist() == [0]
    bad = np.array([[np.nan, 0, 0], [5, np.inf, 0], [5, 0, np.nan], [5, 0, 0], [500, 0, 0], [0, -80.0, 0]])
    assert labels(bad, config)[0].tolist() == [-1, -1, -1, 0, -1, -1]
    label, count = labels(np.full((100_000, 3), 7.0) * [1, 1, 0], config)
    assert count == 1
    assert not label.any()


@pytest.mark.parametrize("config", CONFIGS)
def test_one_cell_and_one_cluster_of_a_hundred_thousand_points(config):
    rng = np.random.default_rng(0)
    cell = np.array([7.0, 7, 0.5 - SENSOR]) + rng.random((100_000, 3)) * [0.01, 0.01, 1.5]
    assert labels(cell, config)[1] == 1
    scene = rng.uniform([-50, -50, 0.3 - SENSOR], [50, 50, 3.4 - SENSOR], (400_000, 3))
    label, _ = labels(scene, config)
    assert np.bincount(label[label >= 0]).max() > 0.9 * len(scene)


@pytest.mark.parametrize("config", CONFIGS)
@pytest.mark.parametrize("height", [np.nan, np.inf, -np.inf])
def test_a_height_that_is_no_number_gives_no_label_and_ties_nothing(config, height):
    points = np.array([[5.0, 0, 0], [5, 0.6, 0], [5, 0.3, 0]])
    found = cluster(points, np.array([1.0, 1.0, height]), np.ones(3, bool), config)
    assert found.label.tolist() == [0, 1, -1]


def test_rows_must_agree():
    with pytest.raises(MessageError, match="one row a point"):
        cluster(np.zeros((3, 3)), np.zeros(2), np.ones(3, bool))
