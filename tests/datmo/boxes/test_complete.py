"""Whole boxes: from the rear alone, from a side alone, from a corner; persons; what no kind suits."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.boxes import BoxConfig, CompleteConfig, fit_boxes
from datmo.boxes.complete import complete
from datmo.boxes.upright import to_axes, upright
from datmo.geometry import corners_bev, iou_bev
from datmo.messages import Clusters, Kind

CONFIG = CompleteConfig()
CAR = (4.3, 1.8, 1.5)
# Axes of the rectangle; the sensor stands at -x.
REAR, SIDE, CORNER = (20.0, 20.3, -0.9, 0.9), (20.0, 20.3, -2.15, 2.15), (20.0, 24.2, -7.0, -5.2)


def one(extent, height=1.5, sensor=(0.0, 0.0), config=CONFIG):
    return complete(np.array([extent]), np.array([height]), np.array([sensor]), config)


@pytest.mark.parametrize(
    ("extent", "height", "whole", "turned", "kind"),
    [
        (REAR, 1.5, (20.0, 24.3, -0.9, 0.9), False, Kind.CAR),
        (SIDE, 1.5, (20.0, 21.8, -2.15, 2.15), True, Kind.CAR),
        (CORNER, 1.5, CORNER, False, Kind.CAR),
        ((20.0, 20.2, -1.25, 1.25), 3.2, (20.0, 29.0, -1.25, 1.25), False, Kind.TRUCK),
        ((20.0, 20.25, -0.25, 0.25), 1.7, (20.0, 20.7, -0.3, 0.25), False, Kind.PEDESTRIAN),
        ((20.0, 26.0, -9.0, 9.0), 3.4, (20.0, 26.0, -9.0, 9.0), True, Kind.UNKNOWN),
    ],
)
def test_what_is_hidden_lies_behind_what_is_seen(extent, height, whole, turned, kind):
    found = one(extent, height)
    assert found.kind[0] == kind
    assert found.turned[0] == turned
    np.testing.assert_allclose(found.extent[0], whole, atol=0.2)
    assert np.all(found.extent[0, ::2] <= np.array(extent)[::2])  # what was seen stays inside
    assert np.all(found.extent[0, 1::2] >= np.array(extent)[1::2])


@pytest.mark.parametrize("extent", [REAR, SIDE, CORNER])
def test_the_side_of_the_sensor_decides_which_end_moves(extent):
    """Mirrored in x, or in y, or with the axes exchanged: so is the result."""
    plain, (x0, x1, y0, y1) = one(extent).extent[0], extent
    np.testing.assert_allclose(one((-x1, -x0, y0, y1)).extent[0], [-plain[1], -plain[0], *plain[2:]])
    np.testing.assert_allclose(one((x0, x1, -y1, -y0)).extent[0][:2], plain[:2])
    swapped = one((y0, y1, x0, x1))
    np.testing.assert_allclose(swapped.extent[0], plain[[2, 3, 0, 1]])
    assert swapped.turned[0] != one(extent).turned[0]


@pytest.mark.parametrize("sensor", [(-20.0, 0.1), (-20.0, -15.0), (0.1, -20.0)])
def test_kinds_by_size(sensor):
    sizes = {
        (0.6, 0.4, 1.75): Kind.PEDESTRIAN,
        (4.3, 1.8, 1.5): Kind.CAR,
        (1.7, 0.3, 1.4): Kind.CAR,
        (5.5, 2.0, 2.5): Kind.VAN,
        (10.0, 2.5, 3.5): Kind.TRUCK,
        (0.3, 0.2, 3.0): Kind.UNKNOWN,
        (9.0, 0.5, 1.0): Kind.UNKNOWN,
    }
    half = np.array(list(sizes))[:, [0, 0, 1, 1]] / 2 * np.array([-1, 1, -1, 1])
    height = np.array([h for _, _, h in sizes])
    found = complete(half, height, np.tile(sensor, (len(sizes), 1)), CONFIG)
    assert found.kind.tolist() == list(sizes.values())


@pytest.mark.parametrize("height", [2.4, 3.0, 3.4])
@pytest.mark.parametrize("width", [0.1, 0.2, 0.3])
def test_a_pole_is_no_part_of_something_large(width, height):
    found = one((20.0, 20.0 + width, -width / 2, width / 2), height)
    assert found.kind[0] == Kind.UNKNOWN
    assert found.size.max() < 0.5


def test_what_was_not_seen_is_less_sure():
    rear, corner = one(REAR), one(CORNER)
    assert rear.var[0, 0] > 4 * rear.var[0, 1]
    assert rear.var[0, 0] > 4 * corner.var[0, 0]
    assert np.all((rear.turn >= 0) & (rear.turn <= 0.5 + 1e-12))
    square = one((20.0, 20.2, -0.35, 0.35), 1.7)
    assert square.turn[0] > one(SIDE).turn[0]


def test_without_kinds_boxes_stay_as_seen():
    found = one(REAR, config=CompleteConfig(kinds=()))
    assert np.array_equal(found.extent[0], REAR)
    assert found.kind[0] == Kind.UNKNOWN
    assert found.turned[0]


@pytest.mark.parametrize("extent", [(5, 5, 1, 1), (0, 0, 0, 0), (-50, 60, -40, 90)])
def test_degenerate_rectangles_are_finite(extent):
    found = one(extent, 0.0)
    for value in (found.extent, found.var, found.turn):
        assert np.isfinite(value).all()
    assert (found.var > 0).all()


def rear_of_a_car(yaw, distance, seed):
    """Returns of the rear face alone, the sensor straight behind: points, truth (centre, size, yaw)."""
    rng = np.random.default_rng(seed)
    ahead, left = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    across, depth = rng.uniform(-0.9, 0.9, 120), rng.uniform(0, 0.15, 120)
    across[:2] = -0.9, 0.9
    xy = (distance + depth)[:, None] * ahead + across[:, None] * left
    z = rng.uniform(0.3, 1.5, 120)
    z[0] = 1.5
    return np.column_stack([xy, z]), (distance + CAR[0] / 2) * ahead


@pytest.mark.parametrize("yaw", [0.0, 0.7, 2.0, -2.5])
def test_a_car_seen_from_behind_has_its_length(yaw):
    points, center = rear_of_a_car(yaw, 25.0, 3)
    labels = Clusters(np.zeros(len(points), np.int32), 1)
    boxes, rejected = fit_boxes(points, labels, np.zeros(len(points)), np.zeros(2), BoxConfig())
    assert not rejected
    true = corners_bev(np.array([center]), np.array([CAR]), np.array([yaw]))[0]
    assert iou_bev(corners_bev(boxes.center, boxes.size, boxes.yaw)[0], true) > 0.8
    assert boxes.kind[0] == Kind.CAR
    error = boxes.center[0, :2] - center
    assert error @ np.linalg.solve(boxes.cov[0, :2, :2], error) < 9.2  # 99 % of two dimensions
    seen = boxes.visible()
    assert seen.size[0, 0] == pytest.approx(1.8, abs=0.05)
    assert seen.size[0, 1] < 0.3
    assert abs(np.cos(seen.yaw[0] - yaw)) < 0.05


def test_upright_turns_the_seen_part_with_the_box():
    """The seen part, carried back to the world, is where the rectangle was, however the length lies."""
    rng = np.random.default_rng(8)
    low = rng.uniform(-20, 20, (40, 2))
    extent = np.column_stack([low, low + rng.uniform(0.2, 4, (40, 2))])[:, [0, 2, 1, 3]]
    angle = rng.uniform(0, np.pi / 2, 40)
    found = complete(extent, np.full(40, 1.5), to_axes(np.zeros(2), angle), CONFIG)
    box = upright(extent, found, angle)
    middle = (box.seen[:, ::2] + box.seen[:, 1::2]) / 2
    c, s = np.cos(box.yaw), np.sin(box.yaw)
    x = box.center[:, 0] + c * middle[:, 0] - s * middle[:, 1]
    y = box.center[:, 1] + s * middle[:, 0] + c * middle[:, 1]
    m = (extent[:, ::2] + extent[:, 1::2]) / 2
    c, s = np.cos(angle), np.sin(angle)
    np.testing.assert_allclose(x, c * m[:, 0] - s * m[:, 1], atol=1e-9)
    np.testing.assert_allclose(y, s * m[:, 0] + c * m[:, 1], atol=1e-9)
    assert np.all(box.size[:, 0] >= box.size[:, 1])
    assert np.all(np.linalg.eigvalsh(box.cov) > 0)
