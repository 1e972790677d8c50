from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from datmo.errors import CloudFileError, ConfigError
from datmo.ground import METHODS
from datmo.messages import Ground, Plane, Scan
from eval.benchmark.ground_boxes import read_boxes
from eval.benchmark.ground_methods import Contestant
from eval.benchmark.ground_real import pitched, play_real, real_paths, real_table, warped
from eval.benchmark.ground_table51 import Line, bootstrap, compare, counts, sentences, table51, table51_rows
from eval.benchmark.ground_table51 import _told as told


def below(height: float) -> Contestant:
    """Calls ground what lies below a height."""

    def step(scan: Scan) -> Ground:
        n = len(scan)
        return Ground(scan.points[:, 2] < height, np.zeros(n), np.zeros(n), Plane())

    return Contestant("below", lambda: step)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """One sweep of four points and one labelled car, 4 x 2 x 1.5 m, its base at (10, 0, -1.7)."""
    boxed = tmp_path / "real" / "boxes" / "000000"
    boxed.mkdir(parents=True)
    # camera x = -y, y = -z, z = x of the sensor
    calibration = "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n\n"
    (boxed / "calib.txt").write_text(calibration)
    label = "0 0 0 0 0 0 0 1.5 2.0 4.0 0 1.7 10 -1.5707963"
    (boxed / "label_2.txt").write_text(f"Car {label}\nDontCare {label}\nCyclist {label}\n")
    points = [[10, 0, -1.65], [11.9, 0.9, -1.5], [8.1, -0.9, -0.3], [10, 1.1, -1.0]]
    np.column_stack([points, np.zeros(4)]).astype("<f4").tofile(boxed / "velodyne.bin")
    return tmp_path


def test_points_in_a_labelled_box_that_are_called_ground(folder: Path) -> None:
    (box,) = read_boxes(folder / "real" / "boxes" / "000000")
    np.testing.assert_allclose(box.base, [10, 0, -1.7], atol=1e-9)
    assert np.cos(box.yaw) == pytest.approx(1, abs=1e-6)
    paths, note = real_paths(folder)
    assert note is None
    (row,) = play_real([below(-1.4)], paths, 1)
    # the first lies at the foot, the last beside the car; of the two others one is called ground
    assert row.frame == "boxes/000000"
    assert row.figures["box_leak"] == 0.5
    assert row.figures["agreement"] is None
    assert real_table([row]).rows[0][-1] == "50.00"


def test_tilted_and_warped() -> None:
    points = np.array([[10, 2, -1.7], [5, 0, 0]], np.float32)
    down = pitched(points, 15)
    np.testing.assert_allclose(down[1], [5 * np.cos(np.pi / 12), 0, -5 * np.sin(np.pi / 12)], atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(down, axis=1), np.linalg.norm(points, axis=1), rtol=1e-6)
    np.testing.assert_allclose(warped(points, 0.6, 20)[:, 2], [-1.7, 0.6], atol=1e-6)


def test_consistency_is_the_share_of_labels_that_change(folder: Path) -> None:
    paths, _ = real_paths(folder)
    (row,) = play_real([below(-1.8)], paths, 1)
    assert row.figures["changed_pitch_15"] == 1.0  # 8 m ahead all sinks by 2 m or more
    assert row.figures["changed_warp_0.6_20"] == 0.25  # the wave lowers only what lies at 11.9 m


def test_wrong_folders(tmp_path: Path) -> None:
    with pytest.raises(CloudFileError, match="no sweep there; give"):
        real_paths(tmp_path)
    with pytest.raises(CloudFileError, match=r"calib\.txt"):
        read_boxes(tmp_path)


def _line(scene: str, method: str, rmse: float | None) -> Line:
    return Line(scene, method, 60.0, 12.0, 30.0, 20.0, 0.01, rmse, 0.1, {"sigma_f": 0.25})


def _pairs(base: Any, other: Any) -> list[Line]:
    made = []
    for i, (a, b) in enumerate(zip(base, other, strict=True)):
        made += [_line(f"s{i}", "z", a), _line(f"s{i}", "zl", b)]
    return made


def test_the_sentence_follows_the_figures() -> None:
    z = np.linspace(0.01, 0.1, 8)
    better = compare(_pairs(z, 0.9 * z), "zl", "z")
    assert better.startswith("zl beats z: its error against the true ground is -10.0 % of z's")
    assert "-10.0 to -10.0 % over 8 frames), smaller on 8 of them (sign test p = 0.0078)" in better
    assert compare(_pairs(z, 1.1 * z), "zl", "z").startswith("zl loses to z")
    mixed = z * np.where(np.arange(8) % 2, 1.2, 1 / 1.2)
    assert compare(_pairs(z, mixed), "zl", "z").startswith("zl cannot be told from z")
    assert "cannot be told" in compare(_pairs(z, z), "zl", "z")
    assert "too few" in compare(_pairs([0.1, None], [0.1, 0.1]), "zl", "z")
    assert len(sentences(_pairs(z, z))) == 1


def test_the_interval_is_that_of_the_mean() -> None:
    values = np.random.default_rng(3).normal(0.3, 1.0, 200)
    low, high = bootstrap(values)
    half = 1.96 * values.std() / np.sqrt(200)
    assert (low, high) == pytest.approx((values.mean() - half, values.mean() + half), abs=0.02)
    assert bootstrap(values) == (low, high)


def test_the_table_tells_points_and_pseudo_inputs() -> None:
    assert counts(np.array([0, 60, 80, 70]), np.array([0, 10, 20, 0])) == (70.0, 15.0)
    assert counts(np.array([5]), np.zeros(0)) == (5.0, None)
    learned = SimpleNamespace(candidates=np.array([4]), supports=np.array([2]), hyper={"sigma_n": 0.02})
    assert told(SimpleNamespace(learned=learned)) == (4.0, 2.0, {"sigma_n": 0.02})  # type: ignore[arg-type]
    row = table51_rows([_line("E-0", "zl", 0.0123)]).rows[0]
    assert row[:4] == ("E-0", "zl", "60", "12")
    assert row[6:] == ("1.00e-02", "0.0123", "0.1000", "sigma_f 0.25")


def test_unknown_methods_are_refused() -> None:
    with pytest.raises(ConfigError, match="'zz' is not known"):
        table51(["zz"], [])
    with pytest.raises(ConfigError, match="methods is empty"):
        table51([], [])
    with pytest.raises(ConfigError, match="rounds is 0"):
        table51(METHODS[:1], [], 0)
