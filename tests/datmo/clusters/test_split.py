"""Cutting a cluster that several predicted boxes share."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.clusters import SplitConfig, split_clusters
from datmo.errors import MessageError
from datmo.messages import Boxes, Clusters


def box(*rows, yaw=0.0, ids=None, speed=0.0):
    """Boxes of rows (x, y, length, width)."""
    rows = np.array(rows, float)
    return Boxes(
        center=np.column_stack([rows[:, :2], np.ones(len(rows))]),
        size=np.column_stack([rows[:, 2:], np.full(len(rows), 1.5)]),
        yaw=np.full(len(rows), yaw),
        velocity=np.full((len(rows), 2), [speed, 0.0]),
        id=np.arange(1, len(rows) + 1) if ids is None else ids,
    )


def patch(x0, x1, y0, y1, n=80):
    """Points of a rectangle, its corners among them."""
    xy = np.random.default_rng(n).uniform([x0, y0], [x1, y1], (n, 2))
    xy[:4] = [[x0, y0], [x0, y1], [x1, y0], [x1, y1]]
    return np.column_stack([xy, np.ones(n)])


def one(*patches):
    points = np.concatenate(patches)
    return points, Clusters(label=np.zeros(len(points)), count=1)


BUMPERS = one(patch(-4.5, -0.1, -0.9, 0.9), patch(0.1, 4.5, -0.9, 0.9))
CARS = box((-2.3, 0, 4.4, 1.8), (2.3, 0, 4.4, 1.8))


def test_two_cars_bumper_to_bumper_come_apart():
    split = split_clusters(*BUMPERS, CARS)
    assert split == Clusters(label=[0] * 80 + [1] * 80, count=2)


def test_two_persons_side_by_side_come_apart():
    points, clusters = one(patch(9.8, 10.2, -0.55, -0.05, 40), patch(9.8, 10.2, 0.05, 0.55, 30))
    persons = box((10, -0.3, 0.5, 0.6), (10, 0.3, 0.5, 0.6))
    assert split_clusters(points, clusters, persons).label.tolist() == [0] * 40 + [1] * 30


def test_a_person_beside_a_car_comes_off():
    points, clusters = one(patch(-2.2, 2.2, -0.9, 0.9, 600), patch(-0.2, 0.3, 1.05, 1.5, 30))
    split = split_clusters(points, clusters, box((0, 0, 4.4, 1.8), (0.05, 1.3, 0.5, 0.5)))
    assert split.label.tolist() == [0] * 600 + [1] * 30


@pytest.mark.parametrize(
    "claims",
    [
        box((0, 0, 4.4, 1.8), (0.4, 0.1, 4.2, 1.8)),
        box((0, 0, 4.4, 1.8), (1.6, 0.0, 1.2, 1.2)),  # a bonnet that became a track
        box((0, 0, 4.4, 1.8), (0.2, 0.1, 1.8, 4.4)),
        box((0, 0, 4.4, 1.8)),
        box((0, 0, 4.4, 1.8), (9, 0, 4.4, 1.8)),
        box((0, 0, 4.4, 1.8), (3.1, 0, 4.4, 1.8)),  # a track that holds but a corner of it
    ],
    ids=["duplicate", "part", "across", "alone", "elsewhere", "corner"],
)
def test_one_object_stays_whole(claims):
    points, clusters = one(patch(-2.2, 2.2, -0.9, 0.9))
    assert split_clusters(points, clusters, claims) == clusters


def test_a_lorry_with_one_box_stays_whole():
    points, clusters = one(patch(-8, 8, -1.2, 1.2, 300))
    assert split_clusters(points, clusters, box((0, 0, 16, 2.5))) == clusters
    assert split_clusters(points, clusters, box((-5, 0, 4, 2.5), speed=8)) == clusters  # it may come to grow
    cab = box((0, 0, 16, 2.5), (6.5, 0, 2.5, 2.5))
    assert split_clusters(points, clusters, cab) == clusters


def test_boxes_that_move_alike_may_be_parts_of_one_body():
    points, clusters = BUMPERS
    alike = CARS.velocity + np.array([5.0, 0])
    for second, count in ((4.5, 1), (5.6, 1), (5.8, 2), (0.0, 2), (-5.0, 2)):
        alike[1, 0] = second
        moving = Boxes(CARS.center, CARS.size, CARS.yaw, velocity=alike, id=CARS.id)
        assert split_clusters(points, clusters, moving).count == count, second


def test_a_box_is_where_it_was_when_the_point_was_measured():
    """Two persons who walked apart since: where they are now, both lie beside what was seen of them."""
    points, clusters = one(patch(9.8, 10.2, -0.55, -0.05, 40), patch(9.8, 10.2, 0.05, 0.55, 30))
    now = box((10, -0.3, 0.5, 0.6), (10, 0.3, 0.5, 0.6))
    apart = Boxes(
        now.center + np.array([[0, -1.0, 0], [0, 1.0, 0]]),
        now.size,
        now.yaw,
        velocity=[[0, -10.0], [0, 10.0]],
        id=now.id,
    )
    dt = np.full(70, -0.1, np.float32)
    assert split_clusters(points, clusters, apart, dt) == split_clusters(points, clusters, now)
    assert split_clusters(points, clusters, apart) == clusters


def test_parts_follow_the_boxes_whatever_the_order_of_the_points():
    points, clusters = BUMPERS
    label = np.append(clusters.label + 1, [0, 2, -1])
    points = np.concatenate([points, [[30.0, 0, 1], [40, 0, 1], [0, 0, 1]]])
    split = split_clusters(points, Clusters(label=label, count=3), CARS)
    assert split.label[-3:].tolist() == [0, 3, -1]
    assert split.count == 4
    order = np.random.default_rng(1).permutation(len(points))
    turned = split_clusters(points[order], Clusters(label=label[order], count=3), CARS)
    assert np.array_equal(turned.label, split.label[order])
    swapped = split_clusters(points, Clusters(label=label, count=3), CARS.select(np.array([1, 0])))
    assert np.array_equal(swapped.label, np.array([0, 2, 1, 3, -1])[split.label])


@pytest.mark.parametrize("seed", range(5))
def test_each_point_goes_to_the_nearest_claim(seed):
    rng = np.random.default_rng(seed)
    yaw = rng.uniform(-3, 3)
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[c, -s], [s, c]])
    local = rng.uniform([-5, -1.5], [5, 1.5], (300, 2))
    points = np.column_stack([local @ turn.T, np.ones(300)])
    centers = np.array([[-2.6, 0.1], [2.6, -0.1]])
    boxes = box(*np.column_stack([centers @ turn.T, [[4.5, 1.8], [4.2, 1.7]]]), yaw=yaw)
    split = split_clusters(points, Clusters(label=np.zeros(300), count=1), boxes)
    for x, y, k in zip(*local.T, split.label, strict=True):
        away = []
        for (cx, cy), (length, width) in zip(centers, boxes.size[:, :2], strict=True):
            dx, dy = abs(x - cx) - length / 2, abs(y - cy) - width / 2
            away.append(max(dx, dy) if dx <= 0 and dy <= 0 else np.hypot(max(dx, 0), max(dy, 0)))
        assert away[k] == pytest.approx(min(away), abs=1e-9)
    assert split.count == 2


def test_nothing_seen_or_nothing_predicted():
    points, clusters = BUMPERS
    assert split_clusters(points, clusters, Boxes.empty()) == clusters
    assert split_clusters(points, clusters, CARS, config=SplitConfig(enabled=False)) == clusters
    nothing = Clusters(label=np.full(4, -1), count=0)
    assert split_clusters(np.full((4, 3), np.nan), nothing, CARS) == nothing
    empty = Clusters(label=np.zeros(0), count=0)
    assert split_clusters(np.zeros((0, 3)), empty, CARS) == empty


@pytest.mark.parametrize("points", [BUMPERS[0][1:], BUMPERS[0][:, :2]])
def test_points_of_another_shape_are_refused(points):
    with pytest.raises(MessageError, match="one row a label"):
        split_clusters(points, BUMPERS[1], CARS)
