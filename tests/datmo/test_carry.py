"""Points of moving objects carried to the stamp."""

from __future__ import annotations

import numpy as np

from datmo.carry import CarryConfig, carry
from datmo.messages import Boxes, Clusters, Scan

VELOCITY = np.array([12.0, -5.0])


def scene(seed=0, velocity=VELOCITY):
    """A moving car and a standing one, scanned over the sweep; both clusters, and the predicted boxes."""
    rng = np.random.default_rng(seed)
    body = rng.uniform([-2, -0.9, 0.3], [2, 0.9, 1.5], (200, 3))
    dt = rng.uniform(-0.07, -0.05, 400).astype(np.float32)
    at_stamp = np.concatenate([body + np.array([20, 5, 0]), body - np.array([15, -8, 0])])
    seen = at_stamp.copy()
    seen[:200, :2] += velocity * dt[:200, None].astype(float)
    label = np.repeat([0, 1], 200).astype(np.int32)
    boxes = Boxes(
        center=[[20, 5, 0.75], [-15, 8, 0.75]],
        size=[[4.2, 1.9, 1.5]] * 2,
        yaw=[np.arctan2(velocity[1], velocity[0]), 0.0],
        velocity=[velocity, [0.1, 0.0]],
    )
    return Scan(points=seen, dt=dt), seen, at_stamp, Clusters(label, 2), boxes


def test_a_moving_object_lies_where_it_is_at_the_stamp():
    scan, seen, at_stamp, clusters, boxes = scene()
    np.testing.assert_allclose(carry(seen, scan, clusters, boxes), at_stamp, atol=1e-9)


def test_what_stands_or_is_unknown_stays():
    scan, seen, _, clusters, boxes = scene()
    assert carry(seen, scan, clusters, boxes.select([1])) is seen
    assert carry(seen, scan, clusters, Boxes.empty()) is seen
    assert carry(seen, Scan(points=seen), clusters, boxes) is seen  # no firing times: a plain cloud
    assert carry(seen, scan, clusters, boxes, CarryConfig(enabled=False)) is seen
    unknown = Boxes(boxes.center, boxes.size, boxes.yaw)
    assert carry(seen, scan, clusters, unknown) is seen
    nothing = Clusters(np.full(len(seen), -1, np.int32), 0)
    assert carry(seen, scan, nothing, boxes) is seen


def test_a_cluster_moves_with_the_box_it_lies_deepest_in():
    """Against the plain rule: the box, at the cluster's time, whose sides its middle is farthest inside."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        k, b = 8, 5
        label = rng.integers(-1, k, 300).astype(np.int32)
        places = rng.uniform(-6, 6, (300, 3))
        dt = rng.uniform(-0.1, 0, 300).astype(np.float32)
        boxes = Boxes(
            rng.uniform(-4, 4, (b, 3)),
            rng.uniform(1, 6, (b, 3)),
            rng.uniform(-3, 3, b),
            rng.normal(0, 9, (b, 2)),
        )
        got = carry(places, Scan(points=places, dt=dt), Clusters(label, k), boxes)
        want = places.copy()
        for c in range(k):
            rows = label == c
            middle, t = places[rows, :2].mean(0), dt[rows].astype(float).mean()
            best, owner = 1.0, None
            for i in range(b):
                d = middle - boxes.center[i, :2] - boxes.velocity[i] * t
                u, w = np.cos(boxes.yaw[i]), np.sin(boxes.yaw[i])
                inside = np.abs([u * d[0] + w * d[1], u * d[1] - w * d[0]])
                depth = (inside / (boxes.size[i, :2] / 2 + CarryConfig().pad)).max()
                if depth < best and np.linalg.norm(boxes.velocity[i]) > 0.5:
                    best, owner = depth, i
            if owner is not None:
                want[rows, :2] -= boxes.velocity[owner] * dt[rows, None].astype(float)
        np.testing.assert_allclose(got, want, atol=1e-6)


def test_order_of_points_does_not_matter():
    scan, seen, _, clusters, boxes = scene(3)
    order = np.random.default_rng(1).permutation(len(seen))
    mixed = Scan(points=scan.points[order], dt=scan.dt[order])
    got = carry(seen[order], mixed, Clusters(clusters.label[order], 2), boxes)
    np.testing.assert_allclose(got, carry(seen, scan, clusters, boxes)[order], atol=1e-9)
