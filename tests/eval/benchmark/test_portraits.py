from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread

from datmo.messages import (
    Boxes,
    Clusters,
    Detections,
    Frame,
    Ground,
    LostRays,
    Scan,
    Tracks,
    Truth,
    Visibility,
)
from eval.benchmark.portrait_plot import plot
from eval.benchmark.portraits import portrait

YAW, SPEED, DT = 0.7, 10.0, -0.05
SENSOR = np.array([3.0, 4.0, 1.7])


@pytest.fixture
def seen() -> tuple[Frame, Truth]:
    """A moving car, its three returns 50 ms older than the stamp; one far return, one on the ground."""
    along = np.array([np.cos(YAW), np.sin(YAW)])
    across = np.array([-along[1], along[0]])
    center = np.array([20.0, 10.0, 0.75])
    local = np.array([[-2.0, 0.9], [0.0, 0.9], [2.0, 0.9]])
    car = np.column_stack([center[:2] + local[:, :1] * along + local[:, 1:] * across, [0.5, 1.0, 0.5]])
    car[:, :2] += SPEED * DT * along
    points = np.vstack([car, [[40.0, 40.0, 1.0], [20.0, 12.0, 0.0]]]) - SENSOR
    T = np.eye(4)
    T[:3, 3] = SENSOR
    scan = Scan(points=points, T_world_sensor=T, dt=np.full(5, DT))
    velocity = SPEED * along[None]
    boxes = Boxes(center[None], np.array([[4.2, 1.8, 1.5]]), np.array([YAW]), velocity, kind=np.array([1]))
    is_ground, three, none = np.array([False] * 4 + [True]), np.array([3], np.int32), np.zeros(0)
    lost = dict.fromkeys(("ring", "column", "actor", "thing", "kind", "range"), none)
    told: dict[str, Any] = {
        "boxes": boxes, "stamp": 0.0, "T_world_actor": np.eye(4)[None], "actor": np.array([0, 0, 0, -1, -1]),
        "thing": np.full(5, -1), "kind": np.array([1, 1, 1, 13, 8]), "is_ground": is_ground,
        "height": np.zeros(5), "normal": np.zeros((5, 3)), "solo": three, "visible": three, "returns": three,
        "lost_to": np.zeros((1, 3)), "visibility": np.array([Visibility.VISIBLE]),
        "lost": LostRays(**lost),  # type: ignore[arg-type]
    }  # fmt: skip
    truth = Truth(**told)
    found = Detections(
        center=np.vstack([center, center + 30]), size=np.vstack([boxes.size, boxes.size]),
        yaw=np.array([YAW, 0.0]), cluster=np.array([1, 0]),
    )  # fmt: skip
    ground = Ground(is_ground, np.zeros(5), np.zeros(5), None)  # type: ignore[arg-type]
    clusters = Clusters(np.array([1, 1, -1, 0, -1]), 2)
    return Frame(scan, ground, clusters, found, Tracks.empty()), truth


def test_a_portrait_stands_at_the_true_place_at_the_stamp(seen: tuple[Frame, Truth]) -> None:
    made = portrait("car", *seen, 0)
    np.testing.assert_allclose(
        made.points, [[-2, 0.9, 0.5], [0, 0.9, 1.0], [2, 0.9, 0.5]], atol=1e-5
    )  # the far return and that on the ground are left out
    assert made.label.tolist() == [1, 1, -1]
    np.testing.assert_allclose(made.truth.center, [[0, 0, 0.75]], atol=1e-9)
    assert made.truth.yaw == 0
    assert len(made.found) == 1  # the box of its cluster alone
    np.testing.assert_allclose(made.found.center, made.truth.center, atol=1e-9)
    assert made.found.yaw == pytest.approx(0)
    turn = np.arctan2(4 - 10, 3 - 20) - YAW
    np.testing.assert_allclose(made.sensor, [np.cos(turn), np.sin(turn)])


def test_the_figure_shows_points_and_boxes(seen: tuple[Frame, Truth]) -> None:
    made = portrait("car", *seen, 0)
    one = imread(io.BytesIO(plot({"car": made})))
    assert one[..., :3].min() < 0.5
    assert plot({"car": made}) == plot({"car": made})
    many = imread(io.BytesIO(plot({str(k): made for k in range(5)})))  # a second line of panels
    assert many.shape[0] > 1.5 * one.shape[0]
    assert imread(io.BytesIO(plot({}))).shape[1] == one.shape[1]
