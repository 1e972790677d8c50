from __future__ import annotations

import json

import numpy as np
import pytest

from datmo.errors import CloudFileError
from datmo.messages import Boxes, Clusters, Scan
from eval import clouds


def write(path, rows):
    path.write_bytes(np.asarray(rows, "<f4").tobytes())
    return path


def test_reads_what_was_written_and_counts_what_is_dropped(tmp_path) -> None:
    rows = np.array([[1, 2, 3, 0.5], [np.nan, 0, 0, 1], [4, 5, 6, np.nan], [7, np.inf, 0, 0], [1, 1, 1, 7.0]])
    read = clouds.read_bin(write(tmp_path / "a.bin", rows))
    assert read.kept.tolist() == [True, False, True, False, True]
    assert read.dropped == 2
    np.testing.assert_array_equal(read.scan.points, rows[[0, 2, 4], :3].astype(np.float32))
    np.testing.assert_allclose(read.scan.intensity, [0.5, 0, 1])


@pytest.mark.parametrize(
    ("content", "says"),
    [(b"", "empty"), (b"\0" * 17, "17 bytes.*16"), (np.full(8, np.nan, "<f4").tobytes(), "none of its 2")],
)
def test_bad_files_say_what_is_wrong(tmp_path, content: bytes, says: str) -> None:
    path = tmp_path / "bad.bin"
    path.write_bytes(content)
    with pytest.raises(CloudFileError, match=says):
        clouds.read_bin(path)


def test_no_file_and_a_folder(tmp_path) -> None:
    with pytest.raises(CloudFileError, match="no such file"):
        clouds.read_bin(tmp_path / "none.bin")
    with pytest.raises(CloudFileError, match="folder"):
        clouds.read_bin(tmp_path)


def test_labels_keep_the_rows_of_the_file() -> None:
    kept = np.array([True, False, True, True])
    label = clouds.labels(np.array([True, False, True]), kept)
    assert label.tolist() == [40, 0, 99, 40]
    assert np.frombuffer(clouds.label_bytes(label), "<u4").tolist() == [40, 0, 99, 40]


def test_boxes_json_counts_points_inside_turned_boxes() -> None:
    box = Boxes(center=[[10.0, 5.0, 0.0]], size=[[4.0, 2.0, 1.5]], yaw=[np.pi / 2], kind=[1], score=[0.9])
    points = np.array([[10, 6.9, 0], [10.9, 5, 0], [11.9, 5, 0], [10, 5, 0]])
    counts = clouds.cluster_sizes(box, Scan(points=points), Clusters([0, 0, 0, -1], 1))
    assert counts.tolist() == [2]
    content = json.loads(clouds.boxes_json(box, counts, "a.bin", 3))
    assert content["dropped_points"] == 3
    (made,) = content["boxes"]
    assert made["center"] == [10, 5, 0]
    assert made["size"] == [4, 2, 1.5]
    assert made["yaw"] == pytest.approx(np.pi / 2, abs=1e-4)
    assert made["kind"] == "car"
    assert made["points"] == 2
