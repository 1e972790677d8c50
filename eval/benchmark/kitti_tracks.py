"""KITTI tracking sequences, with detections and truth of cars in a fixed world frame.

A folder holds detections/NNNN.txt, labels/NNNN.txt and poses/NNNN.txt of each sequence.

detections: frame, type (2 = car), 2-D box x1 y1 x2 y2, score, h, w, l, x, y, z, ry, alpha; by commas.
labels: KITTI's 17 columns: frame, track, type, truncated, occluded, alpha, 2-D box, h, w, l, x, y, z, ry.
poses: row-major 3x4, the camera of each frame to that of the first one.
Camera: x right, y down, z forward; (x, y, z) is the middle of the box's bottom; ry turns about y, from x.

World: that of the first camera, x forward, y left, z up; its tilt against gravity is not known.

Truth is as in KITTI's evaluation of cars (TrackEval, AB3DMOT): a Car is truth, a Van is a distractor,
which may be tracked but need not be. Other types are no truth: a track on one is false. What works in
the image alone is left out: regions of type DontCare, the least height, and the limits of truncation
and occlusion. So every labelled car counts, and false tracks are never excused by a region.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from datmo.arrays import F64, I64, Array
from datmo.errors import CloudFileError
from datmo.geometry import wrap_angle
from datmo.messages import Boxes, Kind

RATE = 10.0  # [Hz]
CAR_TYPE = 2
DETECTION_COLUMNS, LABEL_COLUMNS, POSE_COLUMNS = 15, 17, 12
KINDS = {"Car": Kind.CAR, "Van": Kind.VAN}
WORLD_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Takes the first camera's axes to the world's."""


@dataclass(frozen=True, eq=False)
class Drive:
    """One sequence; everything by frame.

    Attributes:
        name: of its files.
        stamps: (n,) [s].
        detections: n boxes with scores.
        truth: n boxes with ids; kind is car, or van for a distractor.
    """

    name: str
    stamps: F64
    detections: tuple[Boxes, ...]
    truth: tuple[Boxes, ...]

    def __len__(self) -> int:
        return len(self.stamps)


def drives(folder: Path) -> list[str]:
    """Names of the sequences in a folder.

    Raises:
        CloudFileError: there is none.
    """
    names = sorted(path.stem for path in (folder / "detections").glob("*.txt"))
    if not names:
        raise CloudFileError(f"{folder}: no detections/*.txt there; give a folder of KITTI sequences")
    return names


def read_drive(folder: Path, name: str) -> Drive:
    """One sequence.

    Raises:
        CloudFileError: a file is missing or a line of it breaks the format.
    """
    T_first_camera = read_poses(folder / "poses" / f"{name}.txt")
    n = len(T_first_camera)
    detected = read_detections(folder / "detections" / f"{name}.txt", n)
    labelled = read_labels(folder / "labels" / f"{name}.txt", n)
    return Drive(
        name,
        np.arange(n) / RATE,
        _by_frame(*detected, T_first_camera),
        _by_frame(*labelled, T_first_camera),
    )


def read_poses(path: Path) -> F64:
    """T_first_camera (n, 3, 4), one for each frame."""
    rows = [_numbers(path, i, words, POSE_COLUMNS) for i, words in _lines(path)]
    if not rows:
        raise CloudFileError(f"{path}: the file is empty; give one pose a frame")
    return np.array(rows).reshape(-1, 3, 4)


def read_detections(path: Path, frames: int) -> tuple[I64, Boxes]:
    """Frame (k,) of each car detected, and its box [camera of that frame]."""
    rows, frame = [], []
    for i, words in _lines(path, ","):
        values = _numbers(path, i, words, DETECTION_COLUMNS)
        if int(values[1]) == CAR_TYPE:
            frame.append(_frame(path, i, values[0], frames))
            rows.append(values[6:14])
            _check_sides(path, i, values[7:10])
    table = np.array(rows).reshape(-1, 8)
    return np.array(frame, np.int64), _boxes(
        table[:, 1:], score=table[:, 0], kind=np.full(len(rows), Kind.CAR)
    )


def read_labels(path: Path, frames: int) -> tuple[I64, Boxes]:
    """Frame (k,) of each car and van labelled, and its box [camera of that frame]."""
    rows, frame, ids, kinds = [], [], [], []
    for i, words in _lines(path):
        if len(words) < LABEL_COLUMNS or words[2] in KINDS:
            values = _numbers(path, i, words[:2] + words[3:], LABEL_COLUMNS - 1)
            frame.append(_frame(path, i, values[0], frames))
            ids.append(int(values[1]))
            kinds.append(KINDS[words[2]])
            rows.append(values[9:16])
            _check_sides(path, i, values[9:12])
    table = np.array(rows).reshape(-1, 7)
    return np.array(frame, np.int64), _boxes(table, ids=np.array(ids, np.int64), kind=np.array(kinds))


def _boxes(
    table: F64, score: Array | None = None, ids: Array | None = None, kind: Array | None = None
) -> Boxes:
    """Boxes of rows h, w, l, x, y, z, ry in camera axes: (x, y, z) the middle, yaw = ry."""
    middle = table[:, 3:6] - np.column_stack([np.zeros(len(table)), table[:, 0] / 2, np.zeros(len(table))])
    return Boxes(middle, table[:, [2, 1, 0]], table[:, 6], score=score, id=ids, kind=kind)  # type: ignore[arg-type]


def _by_frame(frame: I64, boxes: Boxes, T_first_camera: F64) -> tuple[Boxes, ...]:
    """The boxes of each frame, brought from its camera to the world."""
    R = WORLD_CAMERA @ T_first_camera[frame, :, :3]
    center = np.einsum("kij,kj->ki", R, boxes.center) + T_first_camera[frame, :, 3] @ WORLD_CAMERA.T
    ahead = np.column_stack([np.cos(boxes.yaw), np.zeros(len(frame)), -np.sin(boxes.yaw)])
    ahead = np.einsum("kij,kj->ki", R, ahead)
    yaw = wrap_angle(np.arctan2(ahead[:, 1], ahead[:, 0]))
    made = Boxes(center, boxes.size, yaw, score=boxes.score, id=boxes.id, kind=boxes.kind)
    return tuple(made.select(np.flatnonzero(frame == k)) for k in range(len(T_first_camera)))


def _lines(path: Path, sign: str | None = None) -> list[tuple[int, list[str]]]:
    """Number and words of each line that is not blank."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CloudFileError(f"{path}: cannot be read ({error}); give a text file") from None
    return [(i, line.split(sign)) for i, line in enumerate(text.splitlines(), 1) if line.strip()]


def _numbers(path: Path, line: int, words: Sequence[str], count: int) -> F64:
    try:
        values = np.array([float(word) for word in words])
    except ValueError as error:
        raise CloudFileError(f"{path}, line {line}: {error}; the columns are numbers") from None
    if len(values) != count or not np.isfinite(values).all():
        raise CloudFileError(f"{path}, line {line}: {len(values)} columns; give {count} finite numbers")
    return values


def _frame(path: Path, line: int, value: float, frames: int) -> int:
    if value != int(value) or not 0 <= value < frames:
        raise CloudFileError(f"{path}, line {line}: frame {value:g}; frames go from 0 to {frames - 1}")
    return int(value)


def _check_sides(path: Path, line: int, sides: F64) -> None:
    if (sides <= 0).any():
        raise CloudFileError(f"{path}, line {line}: a side of {sides.min():g} m; sides are more than 0")
