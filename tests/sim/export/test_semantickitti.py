"""Read back with a reader written from the format's description, in numpy alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from datmo.messages import Boxes, Kind, LostRays, Scan, Truth
from sim.export.semantickitti import MOVING_CLASS, STATIC, SemanticKitti

KINDS = [Kind.CAR, Kind.PEDESTRIAN, Kind.TRUCK, Kind.VAN]
SPEEDS = [5.0, 0.0, 0.6, 0.4]


def pose(k: int) -> np.ndarray:
    """A climbing, rolling, turning drive that does not begin at the origin."""
    yaw, pitch, roll = 0.8 + 0.2 * k, 0.05 * k - 0.1, 0.03 * k
    cy, sy, cp, sp, cr, sr = (f(a) for a in (yaw, pitch, roll) for f in (np.cos, np.sin))
    Rz = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    Ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    Rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rz @ Ry @ Rx, [30 + 2 * k, -12 + 1.5 * k, 1.7 + 0.1 * k]
    return T


LANDMARKS = np.random.default_rng(1).uniform(-20, 20, (40, 3)) + np.array([30.0, -12, 0])


def sweep(k: int, ids: list[int]) -> tuple[Scan, Truth]:
    """All the landmarks, and after them one return of each actor."""
    T, m = pose(k), len(LANDMARKS)
    world = np.vstack([LANDMARKS, np.full((len(ids), 3), 5.0)])
    points = (world - T[:3, 3]) @ T[:3, :3]
    scan = Scan(points=points, stamp=k / 10, T_world_sensor=T, intensity=np.linspace(0, 1, len(points)))
    n, a = len(points), len(ids)
    boxes = Boxes(
        center=np.zeros((a, 3)),
        size=np.ones((a, 3)),
        yaw=np.zeros(a),
        velocity=np.c_[SPEEDS[:a], np.zeros(a)],
        id=ids,
        kind=KINDS[:a],
    )
    truth = Truth(
        boxes=boxes,
        stamp=k / 10,
        T_world_actor=np.broadcast_to(np.eye(4), (a, 4, 4)),
        actor=np.r_[np.full(m, -1), np.arange(a)],
        thing=np.full(n, -1),
        kind=np.r_[np.full(m, Kind.FIELD), KINDS[:a]],
        is_ground=np.arange(n) < m,
        height=np.zeros(n),
        normal=np.zeros((n, 3)),
        solo=np.zeros(a),
        visible=np.zeros(a),
        returns=np.zeros(a),
        lost_to=np.zeros((a, a + 2)),
        visibility=np.zeros(a),
        lost=LostRays(*(np.zeros(0) for _ in range(6))),
    )
    return scan, truth


def read(folder: Path) -> dict[str, object]:
    calib = {}
    for line in (folder / "calib.txt").read_text().splitlines():
        key, numbers = line.split(":")
        calib[key] = np.array(numbers.split(), float).reshape(3, 4)
    return {
        "clouds": [np.fromfile(p, "<f4").reshape(-1, 4) for p in sorted((folder / "velodyne").glob("*.bin"))],
        "labels": [np.fromfile(p, "<u4") for p in sorted((folder / "labels").glob("*.label"))],
        "poses": np.loadtxt(folder / "poses.txt", ndmin=2).reshape(-1, 3, 4),
        "times": np.loadtxt(folder / "times.txt", ndmin=1),
        "calib": calib,
    }


@pytest.fixture
def sequence(tmp_path: Path) -> dict[str, object]:
    writer = SemanticKitti(tmp_path / "00")
    for k, ids in enumerate([[70001, 4, 9, 12], [70001, 4, 9], [4, 70001]]):
        writer.add(*sweep(k, ids))
    writer.close()
    return read(tmp_path / "00")


def test_counts_and_names(sequence, tmp_path: Path) -> None:
    assert sorted(p.name for p in (tmp_path / "00" / "velodyne").iterdir()) == [
        f"00000{k}.bin" for k in range(3)
    ]
    assert [len(c) for c in sequence["clouds"]] == [len(v) for v in sequence["labels"]] == [44, 43, 42]
    np.testing.assert_allclose(sequence["times"], [0, 0.1, 0.2])
    np.testing.assert_allclose(sequence["clouds"][0][:, 3], np.linspace(0, 1, 44), atol=1e-6)
    assert set(sequence["calib"]) == {"P0", "P1", "P2", "P3", "Tr"}


def test_still_points_agree_through_the_poses(sequence) -> None:
    """As a reader does it: velodyne pose = Tr^-1 pose Tr."""
    Tr = np.vstack([sequence["calib"]["Tr"], [0, 0, 0, 1]])
    np.testing.assert_allclose(sequence["poses"][0], np.eye(4)[:3], atol=1e-12)
    seen = []
    for cloud, rows in zip(sequence["clouds"], sequence["poses"], strict=True):
        T = np.linalg.inv(Tr) @ np.vstack([rows, [0, 0, 0, 1]]) @ Tr
        seen.append(cloud[:40, :3].astype(float) @ T[:3, :3].T + T[:3, 3])
    np.testing.assert_allclose(seen[1], seen[0], atol=1e-4)
    np.testing.assert_allclose(seen[2], seen[0], atol=1e-4)
    first = pose(0)
    np.testing.assert_allclose(seen[2] @ first[:3, :3].T + first[:3, 3], LANDMARKS, atol=1e-4)


def test_camera_axes_of_the_poses(sequence) -> None:
    """Ahead of the sensor is z of the camera, as in KITTI's own poses."""
    T0, T1 = pose(0), pose(1)
    ahead = T0[:3, 0] @ (T1[:3, 3] - T0[:3, 3])
    assert sequence["poses"][1][2, 3] == pytest.approx(ahead)


def test_moving_and_standing_objects_have_their_classes(sequence) -> None:
    semantic = sequence["labels"][0] & 0xFFFF
    assert semantic.tolist() == [72] * 40 + [252, 30, 258, 10]


def test_instances_stay_with_their_actor(sequence) -> None:
    instance = [v >> 16 for v in sequence["labels"]]
    assert instance[0].tolist() == [0] * 40 + [1, 2, 3, 4]
    assert instance[1][40:].tolist() == [1, 2, 3]
    assert instance[2][40:].tolist() == [2, 1]


def test_every_kind_has_a_class_of_the_format() -> None:
    known = {0, 1, 10, 11, 13, 15, 18, 30, 40, 48, 50, 51, 70, 71, 72, 80, 81, 99}
    assert set(STATIC) == set(Kind)
    assert set(STATIC.values()) <= known
    assert set(MOVING_CLASS.values()) <= set(range(252, 260))
