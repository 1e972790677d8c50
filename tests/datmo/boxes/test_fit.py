"""Boxes from clusters: place, size, yaw, base; invariances; degenerate clusters."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.boxes import BoxConfig, FilterConfig, fit_boxes
from datmo.boxes.config import Criterion
from datmo.clusters import cluster
from datmo.errors import MessageError
from datmo.geometry import wrap_angle
from datmo.messages import Clusters, Detections, Kind

SENSOR = np.zeros(2)
CRITERIA = get_args(Criterion)
OPEN = FilterConfig(
    points=1, length=(0, 1e6), width=(0, 1e6), height=(0, 1e6), area=(0, 1e9), volume=(0, 1e9), clearance=1e9
)
ANYTHING = BoxConfig(
    filter=OPEN.model_copy(update={"ratio_above": 1e9, "slender_height": 1e6, "density": 0.0})
)


def solid(center, size, yaw, seed=0, noise=0.0, slope=(0.0, 0.0)):
    """Returns from the two sides and the top that the origin sees of an upright box, and the ground."""
    rng = np.random.default_rng(seed)
    length, width, height = size
    c, s = np.cos(yaw), np.sin(yaw)
    toward = np.array([[c, s], [-s, c]]) @ -np.asarray(center, float)
    u, v = rng.uniform(-0.5, 0.5, (2, 150))
    u[:2], v[:2] = [-0.5, 0.5], [-0.5, 0.5]
    end = np.column_stack([np.full(150, np.sign(toward[0]) * length / 2), v * width])
    side = np.column_stack([u * length, np.full(150, np.sign(toward[1]) * width / 2)])
    local = np.concatenate([end, side, np.column_stack([u * length, v * width])])
    z = np.concatenate([rng.uniform(0.3, height, 300), np.full(150, height)])
    xy = local @ np.array([[c, s], [-s, c]]) + center + noise * rng.normal(size=local.shape)
    ground = xy @ np.asarray(slope)
    return np.column_stack([xy, z + ground]), ground


def fit(points, ground=None, label=None, sensor=SENSOR, config=ANYTHING):
    points = np.asarray(points, float)
    label = np.zeros(len(points), int) if label is None else np.asarray(label)
    ground = np.zeros(len(points)) if ground is None else ground
    clusters = Clusters(label=label, count=int(label.max(initial=-1)) + 1)
    return fit_boxes(points, clusters, ground, sensor, config)


@settings(max_examples=60, deadline=None)
@given(st.floats(-np.pi, np.pi), st.floats(-np.pi, np.pi), st.floats(8, 40), st.integers(0, 999))
def test_a_car_seen_from_a_corner_is_found(yaw, azimuth, r, seed):
    center = r * np.array([np.cos(azimuth), np.sin(azimuth)])
    view = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]]) @ center
    if abs(view[0]) < 3.2 or abs(view[1]) < 1.9:
        return  # one side only: yaw is known from that side alone
    boxes, _ = fit(*solid(center, (4.4, 1.8, 1.5), yaw, seed, noise=0.015), config=BoxConfig())
    assert len(boxes) == 1
    assert abs((boxes.yaw[0] - yaw + np.pi / 2) % np.pi - np.pi / 2) <= np.deg2rad(2)
    np.testing.assert_allclose(boxes.center[0, :2], center, atol=0.12)
    np.testing.assert_allclose(boxes.size[0], [4.4, 1.8, 1.5], atol=0.25)
    assert boxes.kind[0] == Kind.CAR
    assert -np.pi / 2 <= boxes.yaw[0] < np.pi / 2


def test_boxes_stand_on_a_slope():
    center = np.array([20.0, 6.0])
    boxes, _ = fit(*solid(center, (4.4, 1.8, 1.5), 0.3, slope=(0.1, -0.05)))
    base = boxes.center[0, 2] - boxes.size[0, 2] / 2
    assert base == pytest.approx(center @ [0.1, -0.05], abs=0.1)
    assert boxes.size[0, 2] == pytest.approx(1.5, abs=0.35)  # the top is the highest point, uphill


@settings(max_examples=30, deadline=None)
@given(
    st.integers(0, 2**32 - 1), st.floats(-500, 500), st.floats(-500, 500), st.sampled_from([30, 45, 90, -17])
)
def test_moving_and_turning_the_world_moves_and_turns_the_boxes(seed, dx, dy, degrees):
    points, ground = solid((14, 5), (4.4, 1.8, 1.5), 0.35, seed % 1000, noise=0.02)
    plain, _ = fit(points, ground)
    turn = np.deg2rad(degrees)  # a whole number of steps of the search: the same rectangles are tried
    c, s = np.cos(turn), np.sin(turn)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    shift = np.array([dx, dy, 0.0])
    order = np.random.default_rng(seed).permutation(len(points))
    moved, _ = fit((points @ R.T + shift)[order], ground[order], sensor=shift[:2])
    np.testing.assert_allclose(moved.center, plain.center @ R.T + shift, atol=1e-6)
    np.testing.assert_allclose(moved.size, plain.size, atol=1e-6)
    np.testing.assert_allclose(np.sin(moved.yaw - plain.yaw - turn), 0, atol=1e-6)


@pytest.mark.parametrize("criterion", CRITERIA)
def test_every_criterion_finds_a_box_without_noise(criterion):
    yaw = 0.0 if criterion == "axis-aligned" else 0.35
    points, ground = solid((14, 8), (4.0, 1.6, 1.4), yaw)
    boxes, _ = fit(points, ground, config=ANYTHING.model_copy(update={"criterion": criterion}))
    assert abs(wrap_angle(boxes.yaw[0] - yaw)) <= np.deg2rad(1.5)


DEGENERATE = {
    "one point": [[5, 1, 1]],
    "two points": [[5, 1, 1], [6, 2, 1]],
    "equal points": [[5, 1, 1]] * 50,
    "collinear": np.outer(np.linspace(5, 9, 40), [1, 0.5, 0.1]),
    "at the sensor": [[0, 0, 1]] * 3,
    "around the sensor": [[9, 0, 1], [0, 9, 1], [-9, 0, 1], [0, -9, 1]],
    "below the ground": [[5, 1, -2], [6, 1, -2]],
    "as big as the scene": np.random.default_rng(0).uniform(-80, 80, (20000, 3)),
    "a pole": np.column_stack([np.full(30, 5.0), np.full(30, 1.0), np.linspace(0.3, 6, 30)]),
    "along an axis": np.column_stack([np.linspace(5, 9, 40), np.full(40, 1.0), np.full(40, 1.0)]),
    "a flat wall": np.random.default_rng(1).uniform(0, 2, (200, 3)) * [2, 0, 1] + [5, 1, 0.3],
    "a hundred thousand in one cell": np.random.default_rng(2).uniform(1, 1.25, (100_000, 3)),
    "a hundred thousand at one place": [[5, 1, 1]] * 100_000,
}
ACCEPTED = ("collinear", "along an axis", "a flat wall", "a hundred thousand in one cell")


@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize("case", list(DEGENERATE))
def test_degenerate_clusters(case, criterion):
    config = ANYTHING.model_copy(update={"criterion": criterion})
    points = np.array(DEGENERATE[case], float)
    boxes, rejections = fit(points, config=config)
    assert (len(boxes), rejections) == (1, ())
    for value in (boxes.center, boxes.size, boxes.yaw, boxes.score):
        assert np.isfinite(value).all()
    length, width, height = boxes.size[0]
    assert length >= width >= 0
    assert height >= 0
    c, s = np.cos(boxes.yaw[0]), np.sin(boxes.yaw[0])
    local = (points[:, :2] - boxes.center[0, :2]) @ np.array([[c, -s], [s, c]])
    assert np.all(np.abs(local) <= np.array([length, width]) / 2 + 1e-9)
    assert -np.pi / 2 <= boxes.yaw[0] < np.pi / 2
    boxes, refused = fit(points, config=BoxConfig(criterion=criterion))
    assert (len(boxes), len(refused)) == ((1, 0) if case in ACCEPTED else (0, 1))


@pytest.mark.parametrize("criterion", CRITERIA)
def test_degenerate_clusters_do_not_disturb_each_other(criterion):
    config = ANYTHING.model_copy(update={"criterion": criterion})
    few = [np.array(points, float) for points in DEGENERATE.values() if len(points) <= 200]
    label = np.repeat(2 * np.arange(len(few)), [len(points) for points in few])  # odd ones have no point
    together, rejections = fit(np.concatenate(few), label=label, config=config)
    assert together.cluster.tolist() == list(range(0, 2 * len(few), 2))
    assert [(r.cluster, r.rule) for r in rejections] == [(k, "points") for k in range(1, 2 * len(few) - 1, 2)]
    for k, points in enumerate(few):
        alone, _ = fit(points, config=config)
        for name in ("center", "size", "yaw", "score", "cov", "seen", "shape", "kind"):
            np.testing.assert_array_equal(getattr(together, name)[k], getattr(alone, name)[0])


@pytest.mark.parametrize("criterion", CRITERIA)
def test_a_hundred_thousand_points_of_one_cell_are_one_cluster_and_one_box(criterion):
    points = np.array(DEGENERATE["a hundred thousand in one cell"])
    clusters = cluster(points, points[:, 2], np.ones(len(points), bool))
    boxes, _ = fit_boxes(points, clusters, np.zeros(len(points)), SENSOR, BoxConfig(criterion=criterion))
    assert len(boxes) == clusters.count == 1


def test_labels_boxes_and_rejections_account_for_each_other():
    car, ground = solid((14, 5), (4.4, 1.8, 1.5), 0.35)
    wall = np.column_stack([np.linspace(-20, 20, 200), np.full(200, 12.0), np.linspace(0.3, 2, 200)])
    points = np.concatenate([wall, car, car + np.array([10, 0, 0]), [[5, 5, 1], [np.nan, 0, 0]]])
    label = [0] * 200 + [1] * len(car) + [2] * len(car) + [3, -1]
    ground = np.concatenate([np.zeros(200), ground, ground, [0, np.nan]])
    boxes, rejections = fit(points, ground, label, config=BoxConfig())
    assert [(r.cluster, r.rule) for r in rejections] == [(0, "length"), (3, "points")]
    np.testing.assert_allclose(boxes.center[1] - boxes.center[0], [10, 0, 0], atol=0.1)
    assert np.all((boxes.score > 0.9) & (boxes.score < 1))


def test_a_crown_above_the_ground_is_refused_and_a_van_on_a_hill_is_not():
    crown, ground = solid((14, 5), (3.0, 2.5, 3.5), 0.35, slope=(0.2, 0.1))
    high = crown[:, 2] - ground > 2.1
    assert len(fit(crown, ground, config=BoxConfig())[0]) == 1
    boxes, (rejection,) = fit(crown[high], ground[high], config=BoxConfig())
    assert len(boxes) == 0
    assert rejection.rule == "clearance"
    assert rejection.value == pytest.approx((crown[:, 2] - ground)[high].min())


@pytest.mark.parametrize("criterion", CRITERIA)
def test_no_clusters_no_boxes(criterion):
    config = BoxConfig(criterion=criterion)
    assert fit(np.zeros((0, 3)), config=config) == (Detections.empty(), ())
    assert fit(np.ones((4, 3)), label=[-1] * 4, config=config) == (Detections.empty(), ())


def test_bad_rows_are_refused():
    clusters = Clusters(label=np.zeros(3), count=1)
    with pytest.raises(MessageError, match="one row a point"):
        fit_boxes(np.zeros((2, 3)), clusters, np.zeros(3), SENSOR)
    with pytest.raises(MessageError, match=r"point 1 is .*finite"):
        fit_boxes(np.array([[1, 1, 1], [np.nan, 1, 1], [1, 2, 1]]), clusters, np.zeros(3), SENSOR)
