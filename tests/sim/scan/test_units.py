from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from datmo.errors import ScenarioError
from sim.scan.mask import own_body
from sim.scan.pattern import pattern
from sim.scan.units import COLUMNS, read_unit, unit, unit_names

HDL64 = [name for name in unit_names() if name.startswith("hdl64e")]
FIRST = "hdl64e-s3-20171102"


@pytest.mark.parametrize("name", HDL64)
def test_each_hdl64_is_sane(name: str) -> None:
    one = unit(name)
    assert one.elevation.shape == (64,)
    assert (np.diff(one.elevation) < 0).all()
    assert np.rad2deg(one.elevation[0]) > 1.5
    assert np.rad2deg(one.elevation[-1]) < -24
    assert np.abs(one.azimuth).max() < np.deg2rad(11)
    assert np.abs(one.horizontal_offset).max() <= 0.026
    assert ((one.vertical_offset >= 0) & (one.vertical_offset < 0.22)).all()


@pytest.mark.parametrize("name", HDL64)
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
    assert unit(FIRST).columns(10) * 64 == 133312
    reach = np.array([25.0, 14.0, 12.0, 4.6])  # what these rings typically meet
    seen = []
    for ring, d in zip((0, 31, 32, 63), reach, strict=True):
        p = grid.origins[ring, 0] + d * grid.directions[ring, 0]
        seen.append(np.rad2deg(np.arctan2(p[2], np.hypot(p[0], p[1]))))
    np.testing.assert_allclose(seen, [2.4, -7.8, -8.4, -23.8], atol=1.1)  # KITTI's is another unit


def test_pattern_turns_clockwise_from_the_rear() -> None:
    grid = pattern(unit("hdl64e-utexas"), 10, encoder=False)
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
    grid = pattern(one, 10, encoder=False)
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
    np.testing.assert_allclose(share[40:56:4], [0.02, 0.05, 0.08, 0.18], atol=0.035)
    assert not blind[:40].any()
    azimuth = np.rad2deg(np.arctan2(grid.directions[..., 1], grid.directions[..., 0]))
    assert blind[56:][np.abs(azimuth[56:]) > 162].all()


def test_the_encoder_steps_as_in_real_sweeps() -> None:
    """Real sweeps step by 0.18 degrees, now and then by 0.09; the even grid is never far."""
    stepped, even = pattern(unit(FIRST), 10), pattern(unit(FIRST), 10, encoder=False)
    steps = np.round(np.rad2deg(-np.diff(stepped.rotor)), 6)
    assert set(np.unique(steps)) == {0.09, 0.18}
    assert (steps == 0.18).mean() == pytest.approx(2 * 0.1728 / 0.18 - 1, abs=0.01)
    assert np.rad2deg(np.abs(stepped.rotor - even.rotor)).max() <= 0.045 + 1e-9
    np.testing.assert_array_equal(stepped.time, even.time)


@pytest.mark.parametrize(
    ("name", "rings", "columns", "top", "bottom"),
    [
        ("hdl-32e", 32, 2170, 10.67, -30.67),
        ("vlp-16", 16, 1808, 15.0, -15.0),
        ("os1-128", 128, 2048, 22.5, -22.5),
    ],
)
def test_other_sensors_are_as_their_makers_publish(
    name: str, rings: int, columns: int, top: float, bottom: float
) -> None:
    one = unit(name)
    assert (one.rings, one.columns(10)) == (rings, columns)
    np.testing.assert_allclose(np.rad2deg(one.elevation[[0, -1]]), [top, bottom], atol=0.01)
    assert np.ptp(np.diff(one.elevation)) < 1e-6


def test_beams_of_an_os1_start_off_the_axis() -> None:
    """From the circle of 15.806 mm, at the encoder's azimuth; the beam azimuth is relative to it."""
    grid = pattern(unit("os1-128"), 10, encoder=False)
    n = 0.015806
    for ring in (0, 1, 64, 127):
        start = n * np.array([np.cos(grid.rotor[300]), np.sin(grid.rotor[300]), 0])
        o, d = grid.origins[ring, 300], grid.directions[ring, 300]
        np.testing.assert_allclose(np.cross(start - o, d), 0, atol=2e-6)


@pytest.mark.parametrize("name", unit_names())
@pytest.mark.parametrize("rate", [5.0, 10.0, 20.0])
def test_every_unit_at_every_rate_has_perpendicular_offsets(name: str, rate: float) -> None:
    grid = pattern(unit(name), rate)
    assert grid.columns == round(unit(name).firings / rate)
    np.testing.assert_allclose(np.linalg.norm(grid.directions, axis=-1), 1, atol=1e-12)
    np.testing.assert_allclose((grid.origins * grid.directions).sum(-1), 0, atol=1e-12)
    assert (np.diff(grid.rotor) <= 0).all()
    assert unit(name).source != "not said"


HEADER = ["# source: mine", "# firings: 18000", "# encoder: 3600", "# nearest: 0.5", "# farthest: 90"]
ROWS = ["3,0.1,0,0,0", "2,0.0,0,0,0", "1,-0.1,0,0,0", "0,-0.2,0,0,0"]


def table(header: list[str] = HEADER, rows: list[str] = ROWS) -> str:
    return "\n".join([*header, ",".join(COLUMNS), *rows])


def test_a_table_of_ones_own(tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    path.write_text(table())
    mine = unit(str(path))
    assert (mine.rings, mine.firings, mine.encoder, mine.nearest, mine.farthest) == (4, 18000, 3600, 0.5, 90)
    np.testing.assert_allclose(mine.elevation, [0.1, 0.0, -0.1, -0.2])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (table(rows=[*ROWS[:2], "1,-0.1,0,0,0", "1,-0.2,0,0,0"]), "laser 1 is there 2 times"),
        (table(rows=ROWS[:1] + ROWS[2:]), "laser 2 is missing"),
        (table(rows=[ROWS[1], ROWS[0], *ROWS[2:]]), "row 2 has elevation 0.1000 rad after 0.0000"),
        (table(rows=[*ROWS[:3], "0,-0.1,0,0,0"]), "no elevation twice"),
        (table(rows=[*ROWS[:3], "0,nan,0,0,0"]), "row 4 is '0,nan,0,0,0'"),
        (table(rows=[*ROWS[:3], "0,-0.2,0,0"]), "row 4"),
        (table(rows=[]), "0 lasers"),
        (table(rows=["1,10.67,0,0,0", "0,-30,0,0,0"]), "radians, not degrees"),
        (table(rows=["0,0.1,0,112,0"]), "metres"),
        (table(header=HEADER[:1] + HEADER[2:]), "firings"),
        (table(header=[*HEADER[:4], "# farthest: far"]), "farthest"),
        (table().replace("laser,", "beam,"), "must be laser,elevation"),
        ("", "missing"),
    ],
)
def test_wrong_tables_are_refused(text: str, says: str) -> None:
    with pytest.raises(ScenarioError, match=says) as error:
        read_unit("mine.csv", text)
    assert "mine.csv" in str(error.value)


def test_outlines_of_the_own_body() -> None:
    grid = pattern(unit(FIRST), 10)
    assert not own_body(grid, False).any()
    np.testing.assert_array_equal(own_body(grid, "kitti"), own_body(grid, True))
    flat = own_body(grid, [(-180.0, -10.0), (180.0, -10.0)])
    np.testing.assert_array_equal(flat, np.rad2deg(grid.elevation)[:, None] < np.full(grid.columns, -10.0))
