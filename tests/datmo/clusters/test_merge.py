"""Merging under predicted boxes (Alg. 9, corrected)."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.clusters import MergeConfig, merge_clusters
from datmo.clusters.merge import footprints
from datmo.errors import MessageError
from datmo.messages import Boxes, Clusters

YAW = 0.4


def patch(x0, x1, y0, y1, n=60, yaw=YAW, at=(20.0, 5.0)):
    """Points of a rectangle in the frame of a box at `at`, its corners among them."""
    local = np.random.default_rng(0).uniform([x0, y0], [x1, y1], (n, 2))
    local[:4] = [[x0, y0], [x0, y1], [x1, y0], [x1, y1]]
    c, s = np.cos(yaw), np.sin(yaw)
    return np.column_stack([local @ np.array([[c, s], [-s, c]]) + at, np.ones(n)])


def scene(*patches):
    points = np.concatenate(patches)
    label = np.repeat(np.arange(len(patches)), [len(p) for p in patches])
    return points, Clusters(label=label, count=len(patches))


def box(*rows, yaw=YAW):
    """Boxes of rows (x, y, length, width)."""
    rows = np.array(rows, float)
    return Boxes(
        center=np.column_stack([rows[:, :2], np.ones(len(rows))]),
        size=np.column_stack([rows[:, 2:], np.full(len(rows), 1.5)]),
        yaw=np.full(len(rows), yaw),
    )


CAR = box((20, 5, 4.4, 1.8))


def test_a_car_split_by_a_pole_becomes_one():
    points, clusters = scene(patch(-2.2, -0.6, -0.9, 0.9), patch(0.2, 2.2, -0.9, 0.9), patch(8, 10, -1, 1))
    merged = merge_clusters(points, clusters, CAR)
    assert merged.count == 2
    assert merged.label.tolist() == [0] * 120 + [1] * 60


def test_a_wall_beside_the_car_is_left_out():
    points, clusters = scene(
        patch(-2.2, -0.6, -0.9, 0.7), patch(-9, 9, 0.75, 1.0), patch(0.2, 2.2, -0.9, 0.7)
    )
    merged = merge_clusters(points, clusters, CAR)
    assert merged.label.tolist() == [0] * 60 + [1] * 60 + [0] * 60


def test_what_would_be_larger_than_predicted_stays_apart():
    # each half lies mostly within the box, together they are a metre longer than it
    points, clusters = scene(patch(-3.0, -0.6, -0.9, 0.9), patch(0.2, 2.9, -0.9, 0.9))
    assert merge_clusters(points, clusters, CAR).count == 2
    assert merge_clusters(points, clusters, CAR, MergeConfig(tolerance=1.6, area_factor=1.5)).count == 1


def test_two_clusters_that_two_tracks_claim_never_merge():
    # two persons under one car-sized box that is there as well
    points, clusters = scene(patch(-0.8, -0.4, -0.2, 0.2), patch(0.4, 0.8, -0.2, 0.2))
    c, s = 0.6 * np.cos(YAW), 0.6 * np.sin(YAW)
    persons = box((20 - c, 5 - s, 0.5, 0.5), (20 + c, 5 + s, 0.5, 0.5))
    assert merge_clusters(points, clusters, persons).count == 2
    assert merge_clusters(points, clusters, CAR).count == 1


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_what_lies_in_two_boxes_goes_to_the_one_it_is_nearest_to(order):
    # a person in two halves whose box lies within the box of a car, at its edge
    points, clusters = scene(
        patch(-2.2, 0.4, -0.9, 0.9), patch(1.6, 1.8, -0.2, 0.2, n=20), patch(1.9, 2.1, -0.2, 0.2, n=20)
    )
    c, s = 1.85 * np.cos(YAW), 1.85 * np.sin(YAW)
    boxes = box((20, 5, 4.6, 1.9), (20 + c, 5 + s, 0.6, 0.6)).select(np.array(order))
    assert merge_clusters(points, clusters, boxes).label.tolist() == [0] * 60 + [1] * 40


def test_little_overlap_is_no_candidate():
    points, clusters = scene(patch(-2.2, 0, -0.9, 0.9), patch(0.1, 1.0, 0.6, 1.8))
    assert merge_clusters(points, clusters, box((20, 5, 4.4, 2.8))).count == 1
    assert merge_clusters(points, clusters, CAR).count == 2


def test_lines_and_single_points_have_a_footprint():
    line = patch(-2.0, 2.0, 0.3, 0.3)
    points, clusters = scene(line, patch(0.5, 0.5, -0.5, -0.5, n=4))
    np.testing.assert_allclose(footprints(points, clusters, CAR, 0.1)[0, :, 3] - 0.05, [0.3, -0.5])
    assert merge_clusters(points, clusters, CAR).count == 1


def test_footprints_are_the_extents_along_the_box():
    rng = np.random.default_rng(3)
    points, label = rng.uniform(-20, 20, (300, 3)), rng.integers(-1, 6, 300)
    points[:, :2] = (
        points[:, :2] * 0.1 + np.array([[10, 0], [0, 9], [-5, 5], [3, 1], [4, 2], [0, 0], [90, 9]])[label]
    )
    clusters = Clusters(label=label, count=6)
    boxes = box((9, 1, 6, 4), (-4, 4, 9, 3), (0, 0, 30, 30), yaw=-1.1)
    got = footprints(points, clusters, boxes, 0.1)
    for b in range(3):
        c, s = np.cos(boxes.yaw[b]), np.sin(boxes.yaw[b])
        local = (points[:, :2] - boxes.center[b, :2]) @ np.array([[c, -s], [s, c]])
        for k in range(6):
            low, high = local[label == k].min(0), local[label == k].max(0)
            if got[b, k, 0] > 1e8:  # left out: it must indeed lie outside the box
                half = boxes.size[b, :2] / 2
                assert np.any((low > half) | (high < -half))
            else:
                np.testing.assert_allclose(got[b, k], [low[0], high[0], low[1], high[1]], atol=1e-12)
    assert 3 < np.sum(got[:, :, 0] < 1e8) < 18


def test_nothing_predicted_or_nothing_seen():
    points, clusters = scene(patch(-1, 1, -1, 1), patch(3, 4, -1, 1))
    assert merge_clusters(points, clusters, Boxes.empty()) == clusters
    halves, apart = scene(patch(-2, -0.6, -0.9, 0.9), patch(0.2, 2, -0.9, 0.9))
    assert merge_clusters(halves, apart, CAR, MergeConfig(enabled=False)) == apart
    nothing = Clusters(label=np.full(5, -1), count=0)
    assert merge_clusters(np.full((5, 3), np.nan), nothing, CAR) == nothing
    with pytest.raises(MessageError, match="one row a point"):
        merge_clusters(points[1:], clusters, CAR)


def test_points_without_a_cluster_stay_without():
    points, clusters = scene(patch(-2.2, -0.6, -0.9, 0.9), patch(0.2, 2.2, -0.9, 0.9))
    label = clusters.label.copy()
    label[::7] = -1
    merged = merge_clusters(points, Clusters(label=label, count=2), CAR)
    assert np.array_equal(merged.label == -1, label == -1)
    assert merged.count == 1
