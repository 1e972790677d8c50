from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from datmo.errors import ScenarioError
from sim.scan.hdl64 import unit, unit_names
from sim.scan.mask import own_body
from sim.scan.pattern import columns, pattern


@pytest.mark.parametrize("name", unit_names())
def test_each_unit_is_sane(name: str) -> None:
    one = unit(name)
    assert one.elevation.shape == (64,)
    assert (np.diff(one.elevation) < 0).all()
    assert np.rad2deg(one.elevation[0]) > 1.5
    assert np.rad2deg(one.elevation[-1]) < -24
    assert np.abs(one.azimuth).max() < np.deg2rad(11)
    assert np.abs(one.horizontal_offset).max() <= 0.026
    assert ((one.vertical_offset >= 0) & (one.vertical_offset < 0.22)).all()


@pytest.mark.parametrize("name", unit_names())
def test_tables_are_those_of_the_calibration_files(name: str, real_data: Path) -> None:
    path = real_data / "hdl64" / f"{name.replace('-', '_').replace('.', '_')}.csv"
    table = np.genfromtxt(path, delimiter=",", names=True)
    order = np.argsort(-table["vert_correction_rad"], kind="stable")
    one = unit(name)
    np.testing.assert_allclose(one.elevation, table["vert_correction_rad"][order], atol=1e-8)
    np.testing.assert_allclose(one.azimuth, table["rot_correction_rad"][order], atol=1e-8)
    np.testing.assert_allclose(one.vertical_offset, table["vert_offset_m"][order], atol=1e-6)
    np.testing.assert_allclose(one.horizontal_offset, table["horiz_offset_m"][order], atol=1e-6)


def test_unknown_unit_names_the_nearest() -> None:
    with pytest.raises(ScenarioError, match="hdl64e-s3-xiesc"):
        unit("hdl64e-s3-xiesk")


def test_default_unit_seen_from_the_origin_matches_real_sweeps() -> None:
    """+2.4 .. -7.8 and -8.4 .. -23.8 degrees from the origin, at street distances."""
    grid = pattern(unit("hdl64e-s3-20171102"), 10)
    assert grid.directions.shape == (64, 2083, 3)
    assert columns(10) * 64 == 133312
    reach = np.array([25.0, 14.0, 12.0, 4.6])  # what these rings typically meet
    seen = []
    for ring, d in zip((0, 31, 32, 63), reach, strict=True):
        p = grid.origins[ring, 0] + d * grid.directions[ring, 0]
        seen.append(np.rad2deg(np.arctan2(p[2], np.hypot(p[0], p[1]))))
    np.testing.assert_allclose(seen, [2.4, -7.8, -8.4, -23.8], atol=1.1)  # KITTI's is another unit


def test_pattern_turns_clockwise_from_the_rear() -> None:
    grid = pattern(unit("hdl64e-utexas"), 10)
    assert grid.time[-1] == 0
    assert grid.time[0] == pytest.approx(-0.1 + 0.1 / 2083)
    ring = 10
    a = np.arctan2(grid.directions[ring, :, 1], grid.directions[ring, :, 0]) - grid.azimuth[ring]
    a = (a + np.pi) % (2 * np.pi) - np.pi
    assert a[0] > np.deg2rad(179)  # just past the rear, on the left
    assert np.isclose(a[2083 // 4], np.pi / 2, atol=0.01)  # left, before
    assert np.isclose(a[3 * 2083 // 4], -np.pi / 2, atol=0.01)  # right
    np.testing.assert_allclose(np.linalg.norm(grid.directions, axis=-1), 1, atol=1e-12)
    np.testing.assert_allclose((grid.origins * grid.directions).sum(-1), 0, atol=1e-12)


def test_points_follow_the_driver_of_the_unit() -> None:
    """The formula of ROS's velodyne driver, written out for one ray (rotation angle clockwise)."""
    one, C = unit("hdl64e-s3-xiesc"), 2083
    grid = pattern(one, 10)
    ring, c, d = 37, 411, 17.3
    rotation = -(np.pi - 2 * np.pi * (c + 1) / C) - one.azimuth[ring]
    V, v, h = one.elevation[ring], one.vertical_offset[ring], one.horizontal_offset[ring]
    flat = d * np.cos(V) - v * np.sin(V)
    x_driver = flat * np.sin(rotation) - h * np.cos(rotation)
    y_driver = flat * np.cos(rotation) + h * np.sin(rotation)
    want = [y_driver, -x_driver, d * np.sin(V) + v * np.cos(V)]
    got = grid.origins[ring, c] + d * grid.directions[ring, c]
    np.testing.assert_allclose(got, want, atol=1e-12)


def test_own_body_takes_what_it_takes_in_real_sweeps() -> None:
    """Shares of rings 56..63, all beyond 160 degrees, and a window ahead (data of ten real sweeps)."""
    grid = pattern(unit("hdl64e-s3-20171102"), 10)
    blind = own_body(grid)
    share = blind.mean(1)
    np.testing.assert_allclose(share[56:], [0.22, 0.30, 0.33, 0.34, 0.38, 0.41, 0.42, 0.47], atol=0.03)
    assert not blind[:47].any()
    azimuth = np.rad2deg(np.arctan2(grid.directions[..., 1], grid.directions[..., 0]))
    assert blind[56:][np.abs(azimuth[56:]) > 162].all()
