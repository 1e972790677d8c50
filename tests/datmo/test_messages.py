from __future__ import annotations

import numpy as np
import pytest

from datmo.errors import MessageError
from datmo.messages import Boxes, Clusters, Detections, Frame, Ground, Plane, Scan, Sight, Tracks, visibility


def scan(n: int = 4) -> Scan:
    return Scan(points=np.arange(3.0 * n).reshape(n, 3))


def boxes(k: int = 2) -> Boxes:
    return Boxes(center=np.zeros((k, 3)), size=np.ones((k, 3)), yaw=np.zeros(k))


def test_points_alone_make_a_scan() -> None:
    s = scan()
    assert s.points.dtype == np.float32
    assert s.deskewed
    assert np.array_equal(s.T_world_sensor, np.eye(4))
    assert not s.intensity.any()
    assert not s.ring.any()
    assert not s.dt.any()


def test_equality_is_by_content_with_nan_equal_to_nan() -> None:
    a, b = boxes(), boxes()
    assert np.isnan(a.velocity).all()
    assert a == b
    assert a != Boxes(center=np.ones((2, 3)), size=np.ones((2, 3)), yaw=np.zeros(2))
    assert scan() != boxes()


def test_times_are_not_compared() -> None:
    def frame(ms: float) -> Frame:
        ground = Ground(np.zeros(4, bool), np.zeros(4), np.zeros(4), Plane())
        clusters = Clusters(np.full(4, -1))
        return Frame(scan(), ground, clusters, boxes(), Tracks(boxes()), {"ground": ms})

    assert frame(1.0) == frame(2.0)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Scan(points=np.zeros((3, 2))),
        lambda: Scan(points=np.zeros((3, 3)), ring=np.zeros(2)),
        lambda: Scan(points=[["a", "b", "c"]]),
        lambda: Scan(points=np.zeros((1, 3)), stamp=np.nan, ring=np.zeros(1)),
        lambda: Scan(points=np.zeros((1, 3)), T_world_sensor=np.full((4, 4), np.nan)),
        lambda: Scan(points=np.zeros((1, 3)), T_world_sensor=np.zeros((4, 4))),
        lambda: Scan(points=np.zeros((1, 3)), T_world_sensor=np.diag([1.0, 1.0, -1.0, 1.0])),
        lambda: Boxes(center=np.zeros((1, 3)), size=np.zeros((2, 3)), yaw=np.zeros(1)),
        lambda: Clusters(np.array([0, 1, 2]), count=2),
        lambda: Tracks(boxes(), cov=np.zeros((2, 4, 4))),
    ],
)
def test_wrong_shapes_are_refused_by_name(make) -> None:
    with pytest.raises(MessageError, match=r"Scan[. ]|Boxes\.|Clusters\.|Tracks\."):
        make()


def test_select_keeps_rows_aligned() -> None:
    b = Boxes(center=np.arange(9.0).reshape(3, 3), size=np.ones((3, 3)), yaw=np.arange(3.0), id=[5, 6, 7])
    picked = b.select(np.array([2, 0]))
    assert picked.id.tolist() == [7, 5]
    assert picked.yaw.tolist() == [2, 0]


def test_plane_answers_anywhere() -> None:
    mean, std = Plane(0.1, -0.2, -1.7, 0.5)(np.array([[10.0, 5.0], [0.0, 0.0]]))
    np.testing.assert_allclose(mean, [1 - 1 - 1.7, -1.7])
    np.testing.assert_array_equal(std, [0.5, 0.5])


def test_sight_looks_in_the_direction_of_a_place() -> None:
    near, far = np.zeros((60, 720)), np.zeros((60, 720))
    near[52, 360], far[52, 360] = 9.0, 11.0  # azimuth 0..0.5 deg, elevation 0..0.5 deg
    T = np.eye(4)
    T[:3, 3] = [100, 0, 0]
    distance, n, f = Sight(near, far, T).look(np.array([[120.0, 0.01, 0.01], [80.0, 0.0, 0.0]]))
    np.testing.assert_allclose(distance, [20, 20], rtol=1e-4)
    assert (n[0], f[0]) == (9.0, 11.0)
    assert np.isnan(n[1])
    assert np.isnan(f[1])


@pytest.mark.parametrize(
    ("solo", "seen", "expected"),
    [(4, 4, 0), (5, 4, 1), (100, 5, 2), (100, 19, 2), (100, 20, 3), (100, 79, 3), (100, 80, 4), (5, 5, 4)],
)
def test_visibility_is_the_first_class_that_applies(solo: int, seen: int, expected: int) -> None:
    assert visibility(np.array([solo]), np.array([seen])).tolist() == [expected]


def test_the_whole_extent_lies_along_what_is_seen():
    """A car of which the rear alone is seen: its seen part is longer across."""
    rear = Detections([[0, 0, 0]], [[4.5, 1.8, 1.5]], [0.3], seen=[[-2.25, -2.05, -0.9, 0.9]])
    assert rear.visible().size[0, :2] == pytest.approx([1.8, 0.2])
    assert rear.whole_extent()[0] == pytest.approx([1.8, 4.5])
    side = Detections([[0, 0, 0]], [[4.5, 1.8, 1.5]], [0.3], seen=[[-2.25, 2.25, 0.7, 0.9]])
    assert side.whole_extent()[0] == pytest.approx([4.5, 1.8])
    plain = Boxes([[0, 0, 0]], [[4.5, 1.8, 1.5]], [0.3])
    assert plain.whole_extent()[0] == pytest.approx([4.5, 1.8])
