"""Labelled objects of real sweeps: their points are in one cluster, and that cluster has a box."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.boxes import fit_boxes
from datmo.clusters import cluster
from datmo.geometry import corners_bev, inverse, overlap_bev
from datmo.ground import segment_ground

MARGIN = 0.1  # labels are drawn tightly [m]


def labelled(folder):
    """Type, middle of the base [m, sensor], size and yaw of each labelled object."""
    rows = dict(line.split(":") for line in (folder / "calib.txt").read_text().splitlines() if ":" in line)
    T_camera_sensor, R = np.eye(4), np.eye(4)
    T_camera_sensor[:3] = np.array(rows["Tr_velo_to_cam"].split(), float).reshape(3, 4)
    R[:3, :3] = np.array(rows["R0_rect"].split(), float).reshape(3, 3)
    T_sensor_camera = inverse(R @ T_camera_sensor)
    for line in (folder / "label_2.txt").read_text().splitlines():
        name, *values = line.split()
        if name == "DontCare":
            continue
        h, w, length, x, y, z, ry = map(float, values[7:14])
        base = (T_sensor_camera @ [x, y, z, 1])[:3]
        ahead = T_sensor_camera[:3, :3] @ [np.cos(ry), 0, -np.sin(ry)]
        yield name, base, (length, w, h), np.arctan2(ahead[1], ahead[0])


def within(points, base, size, yaw):
    c, s = np.cos(yaw), np.sin(yaw)
    local = (points - base) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    low = np.array([-size[0] / 2, -size[1] / 2, 0]) - MARGIN
    return np.all((local > low) & (local < np.array([size[0] / 2, size[1] / 2, size[2]]) + MARGIN), axis=1)


def detect(path):
    points = np.fromfile(path, np.float32).reshape(-1, 4)[:, :3].copy()
    ground = segment_ground(points)
    above = points[:, 2] - ground.height
    clusters = cluster(points, above, ~ground.is_ground)
    boxes, rejections = fit_boxes(points, clusters, ground.height, np.zeros(2))
    return points, above, clusters, boxes, rejections


@pytest.mark.parametrize("frame", ["000000", "000001"])
def test_labelled_objects_with_fifty_returns_are_in_one_cluster_with_a_box(real_data, frame):
    folder = real_data / "real" / "boxes" / frame
    points, above, clusters, boxes, rejections = detect(folder / "velodyne.bin")
    kept = np.setdiff1d(np.arange(clusters.count), [r.cluster for r in rejections])
    met = 0
    for name, base, size, yaw in labelled(folder):
        own = within(points, base, size, yaw) & (above > 0.3)
        if own.sum() < 50:
            continue
        met += 1
        labels, counts = np.unique(clusters.label[own], return_counts=True)
        largest = labels[np.argmax(counts)]
        assert counts.max() >= 0.95 * own.sum(), name
        assert largest in kept, name
        row = int(np.flatnonzero(kept == largest)[0])
        assert np.sum(clusters.label == largest) <= 1.2 * own.sum() + 30, f"{name} is tied to something else"
        label = corners_bev(base[None], np.array([size]), np.array([yaw]))[0]
        box = corners_bev(boxes.center, boxes.size, boxes.yaw)[row]
        assert overlap_bev(box, label) > 0, f"the box of {name} lies elsewhere"
        assert np.all(boxes.size[row] <= np.array([max(size[:2]), max(size[:2]), size[2]]) + 0.4), name
    assert met >= 1


@pytest.mark.parametrize("frame", ["000000", "000001", "000002"])
def test_real_sweeps_give_boxes_of_plausible_number_and_size(real_data, frame):
    points, _, clusters, boxes, rejections = detect(real_data / "real" / "frames" / f"{frame}.bin")
    assert len(boxes) + len(rejections) == clusters.count
    assert 40 <= len(boxes) <= 160
    cars = (
        (boxes.size[:, 0] > 3) & (boxes.size[:, 0] < 5.5) & (boxes.size[:, 1] > 1) & (boxes.size[:, 1] < 2.3)
    )
    assert cars.sum() >= 5  # parked on both sides of the street
    held = np.isin(clusters.label, [r.cluster for r in rejections if r.rule in ("length", "width", "area")])
    assert held.sum() >= 0.2 * len(points[clusters.label >= 0])  # walls and hedges
