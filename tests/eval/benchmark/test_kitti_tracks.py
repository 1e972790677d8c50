from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from datmo.errors import CloudFileError
from datmo.messages import Kind
from eval.benchmark.kitti_tracks import drives, read_drive

STILL = "1 0 0 0 0 1 0 0 0 0 1 0"
TURNED = "0 0 1 2 0 1 0 0 -1 0 0 5"
"""The camera looks to the right and stands 2 m to the right of the first one and 5 m before it."""
AHEAD = "1.5 1.6 4 0 1.7 10 -1.5707963"
"""A car 10 m ahead that looks away, its bottom 1.7 m below the camera."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for part in ("detections", "labels", "poses"):
        (tmp_path / part).mkdir()
    commas = AHEAD.replace(" ", ",")
    detections = f"0,2,1,2,3,4,7.5,{commas},0\n1,2,1,2,3,4,-0.5,{commas},0\n1,1,1,2,3,4,9,{commas},0\n"
    labels = "".join(
        f"{frame} {track} {kind} 0 0 0 1 2 3 4 {AHEAD}\n"
        for frame, track, kind in ((0, 4, "Car"), (0, 2, "Van"), (1, 4, "Car"), (1, 9, "Cyclist"))
    )
    (tmp_path / "detections" / "0007.txt").write_text(detections)
    (tmp_path / "labels" / "0007.txt").write_text(labels + "1 -1 DontCare -1 -1" + " -10" * 12 + "\n")
    (tmp_path / "poses" / "0007.txt").write_text(f"{STILL}\n{TURNED}\n")
    return tmp_path


def test_a_car_ahead_lies_on_x(folder: Path) -> None:
    assert drives(folder) == ["0007"]
    drive = read_drive(folder, "0007")
    np.testing.assert_allclose(drive.stamps, [0, 0.1])
    first, second = drive.detections
    np.testing.assert_allclose(first.center, [[10, 0, -0.95]], atol=1e-6)
    np.testing.assert_allclose(first.size, [[4, 1.6, 1.5]])
    np.testing.assert_allclose(first.yaw, [0], atol=1e-6)
    assert first.score == pytest.approx([7.5])
    # 10 m before a camera that looks to the right, from 2 m to the right and 5 m ahead
    np.testing.assert_allclose(second.center, [[5, -12, -0.95]], atol=1e-6)
    np.testing.assert_allclose(second.yaw, [-np.pi / 2], atol=1e-6)


def test_cars_are_truth_and_vans_distract(folder: Path) -> None:
    first, second = read_drive(folder, "0007").truth
    assert first.id.tolist() == [4, 2]
    assert first.kind.tolist() == [Kind.CAR, Kind.VAN]
    assert second.id.tolist() == [4]


@pytest.mark.parametrize(
    ("part", "line", "says"),
    [
        ("poses", "1 0 0 0", "line 3: 4 columns; give 12"),
        ("poses", "1 0 0 0 0 1 0 0 0 0 1 nan", "line 3: 12 columns; give 12 finite"),
        ("detections", "0,2,x", "line 4: .*'x'.*numbers"),
        ("detections", "7,2,1,2,3,4,7.5,1,1,1,0,0,9,0,0", "line 4: frame 7; frames go from 0 to 1"),
        ("detections", "0,2,1,2,3,4,7.5,1,0,1,0,0,9,0,0", "line 4: a side of 0 m"),
        ("labels", "0 4 Car 0 0", "line 6: 4 columns; give 16"),
        ("labels", f"0.5 4 Car 0 0 0 1 2 3 4 {AHEAD}", "line 6: frame 0.5"),
    ],
)
def test_wrong_lines_are_named(folder: Path, part: str, line: str, says: str) -> None:
    with (folder / part / "0007.txt").open("a") as file:
        file.write(line + "\n")
    with pytest.raises(CloudFileError, match=rf"{part}/0007\.txt, {says}"):
        read_drive(folder, "0007")


def test_missing_files_are_named(folder: Path, tmp_path: Path) -> None:
    (folder / "poses" / "0007.txt").unlink()
    with pytest.raises(CloudFileError, match=r"poses/0007\.txt: cannot be read"):
        read_drive(folder, "0007")
    with pytest.raises(CloudFileError, match="give a folder of KITTI"):
        drives(tmp_path / "poses")
