from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from datmo import Datmo, Scan
from datmo.clusters import SplitConfig
from datmo.config import DatmoConfig
from datmo.errors import ConfigError
from datmo.geometry import transform
from datmo.pipeline import ground_below


def read(path: Path) -> np.ndarray:
    return np.fromfile(path, np.float32).reshape(-1, 4)


def frames(real_data: Path) -> list[Path]:
    return sorted((real_data / "real" / "frames").glob("*.bin"))


def test_real_sweeps_flow_through(real_data: Path) -> None:
    datmo = Datmo()
    for k, path in enumerate(frames(real_data)):
        cloud = read(path)
        frame = datmo.step(Scan(points=cloud[:, :3], intensity=cloud[:, 3], stamp=k / 10))
        n = len(cloud)
        assert len(frame.ground) == len(frame.clusters.label) == n
        assert 0.3 < frame.ground.is_ground.mean() < 0.8
        assert len(frame.boxes) > 5
        assert np.isfinite(frame.boxes.center).all()
        assert not (frame.ground.is_ground & (frame.clusters.label >= 0)).any()
    assert len(frame.tracks) > 10


def test_ground_agrees_with_patchworkpp(real_data: Path) -> None:
    patchwork = pytest.importorskip("pypatchworkpp")
    settings = patchwork.Parameters()
    settings.verbose = False
    for path in frames(real_data):
        cloud = read(path)
        peer = patchwork.patchworkpp(settings)
        peer.estimateGround(cloud)
        theirs = np.zeros(len(cloud), bool)
        theirs[peer.getGroundIndices()] = True
        ours = Datmo().step(Scan(points=cloud[:, :3])).ground.is_ground
        assert (ours == theirs).mean() >= 0.95


def test_the_same_scans_give_the_same_frames(real_data: Path) -> None:
    def play() -> list[object]:
        datmo = Datmo()
        return [
            datmo.step(Scan(points=read(p)[:, :3], stamp=k / 10)) for k, p in enumerate(frames(real_data)[:2])
        ]

    assert play() == play()


def test_time_that_does_not_go_on_begins_a_new_sequence() -> None:
    car = np.random.default_rng(2).uniform([8, -1, -1.7], [12, 1, -0.2], (300, 3))
    datmo = Datmo()
    for k in range(3):
        frame = datmo.step(Scan(points=car, stamp=k / 10))
        assert "sequence" not in frame.notes
    grown = frame.tracks.status.max()
    frame = datmo.step(Scan(points=car, stamp=0.1))
    assert "does not follow" in frame.notes["sequence"]
    assert frame.tracks.status.max() < grown


@pytest.mark.parametrize("n", [0, 1, 7])
def test_hardly_any_points_are_no_trouble(n: int) -> None:
    frame = Datmo().step(Scan(points=np.full((n, 3), 5.0)))
    assert len(frame.ground) == n
    assert len(frame.boxes) == 0
    assert len(frame.tracks) == 0


def test_points_that_are_not_finite_are_left_out() -> None:
    rng = np.random.default_rng(0)
    xy = rng.uniform(-20, 20, (4000, 2))
    points = np.c_[xy, np.full(len(xy), -1.7)]
    broken = points.copy()
    broken[::10] = np.nan
    frame = Datmo().step(Scan(points=broken))
    assert not frame.ground.is_ground[::10].any()
    assert (frame.clusters.label[::10] == -1).all()
    assert frame.ground.is_ground[1::10].mean() > 0.9


def passing(split: bool) -> list[bool]:
    """Two persons pass each other at 0.4 m: in which scans most of both lies in one cluster."""
    rng = np.random.default_rng(4)
    ground = np.c_[rng.uniform(-25, 25, (6000, 2)), np.full(6000, -1.7)]
    body = rng.uniform([-0.2, -0.25, -1.65], [0.2, 0.25, 0.0], (120, 3))
    datmo = Datmo(DatmoConfig(split=SplitConfig(enabled=split)))
    together = []
    for k in range(41):
        y = 0.13 * (k - 20)
        points = np.concatenate([ground, body + np.array([8.1, y, 0]), body[:90] + np.array([8.9, -y, 0])])
        label = datmo.step(Scan(points=points, stamp=k / 10)).clusters.label[len(ground) :]
        main = [np.bincount(own[own >= 0]).argmax() for own in (label[:120], label[120:])]
        together.append(bool(main[0] == main[1]))
    return together


def test_two_tracks_that_meet_come_apart() -> None:
    assert sum(passing(split=False)) >= 5
    assert not any(passing(split=True))


def test_ground_below_is_the_ground_in_the_world() -> None:
    T = np.eye(4)
    c, s = np.cos(0.2), np.sin(0.2)
    T[:3, :3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    T[:3, 3] = [100, 50, 7]
    points = np.random.default_rng(1).uniform(-10, 10, (500, 3))
    frame = Datmo().step(Scan(points=points, T_world_sensor=T))
    feet = np.c_[points[:, :2].astype(np.float32), frame.ground.height]
    np.testing.assert_allclose(ground_below(frame.scan, frame.ground), transform(T, feet)[:, 2], atol=1e-9)


def test_an_unknown_ground_method_offers_the_nearest() -> None:
    with pytest.raises(ConfigError, match="'z-se'"):
        DatmoConfig().with_ground("zse")


def test_points_on_one_line_are_a_thin_box_that_the_tracker_takes() -> None:
    rng = np.random.default_rng(0)
    floor = np.column_stack([rng.uniform(-30, 30, (30000, 2)), np.full(30000, -1.7)])
    line = np.column_stack([np.full(200, 8.0), np.linspace(-2, 2, 200), np.full(200, -0.5)])
    frame = Datmo().step(Scan(points=np.concatenate([floor, line])))
    assert len(frame.boxes) == 1
    assert (frame.boxes.visible().size > 0).all()
    assert "boxes dropped" not in frame.notes
    assert len(frame.tracks.boxes) == 1
