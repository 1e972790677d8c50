"""SemanticKITTI: velodyne/, labels/, poses.txt, calib.txt, times.txt of one sequence.

Format: Behley et al., "SemanticKITTI", ICCV 2019, and the KITTI odometry devkit.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from datmo.arrays import F64, Array
from datmo.errors import OutputError
from datmo.geometry import inverse
from datmo.messages import Kind, Scan, Truth

MOVING = 0.5
"""Above this speed [m/s] an object has its moving label."""

STATIC: dict[Kind, int] = {
    Kind.UNKNOWN: 0,
    Kind.CAR: 10,
    Kind.VAN: 10,
    Kind.TRUCK: 18,
    Kind.BUS: 13,
    Kind.MOTORCYCLE: 15,
    Kind.BICYCLE: 11,
    Kind.PEDESTRIAN: 30,
    Kind.ROAD: 40,
    Kind.SIDEWALK: 48,
    Kind.FIELD: 72,
    Kind.VEGETATION: 70,
    Kind.TRUNK: 71,
    Kind.BUILDING: 50,
    Kind.WALL: 51,
    Kind.POLE: 80,
    Kind.SIGN: 81,
    Kind.THING: 99,
    Kind.FALSE_RETURN: 1,
}
"""SemanticKITTI has no vans: a van is a car there. Walls count as fence."""

MOVING_CLASS: dict[Kind, int] = {
    Kind.CAR: 252,
    Kind.VAN: 252,
    Kind.TRUCK: 258,
    Kind.BUS: 257,
    Kind.MOTORCYCLE: 255,
    Kind.BICYCLE: 253,
    Kind.PEDESTRIAN: 254,
}
"""A two-wheeler that moves has a rider: moving-motorcyclist, moving-bicyclist."""

T_CAM_VELO: F64 = np.array([[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]], float)
"""Camera 0 stands where the sensor stands: x right, y down, z forward."""

PROJECTION: F64 = np.array([[700, 0, 620, 0], [0, 700, 188, 0], [0, 0, 1, 0]], float)
"""There is no camera; readers want one: a plain pinhole of 1240 x 376 pixels."""


def semantic_classes(truth: Truth) -> Array:
    """SemanticKITTI class (n,) of each return; moving and static objects apart by their speed."""
    table = np.zeros(256, np.uint32)
    for kind, code in STATIC.items():
        table[kind] = code
    label: Array = table[truth.kind]
    speed = np.hypot(truth.boxes.velocity[:, 0], truth.boxes.velocity[:, 1])
    moving = np.array([MOVING_CLASS.get(Kind(k), table[k]) for k in truth.boxes.kind], np.uint32)
    of_box = np.where(speed > MOVING, moving, table[truth.boxes.kind])
    on_actor = truth.actor >= 0
    label[on_actor] = of_box[truth.actor[on_actor]]
    return label


def numbers(rows: Array) -> str:
    """Numbers of a transform or projection (3, 4) in one line, as KITTI writes them."""
    return " ".join(f"{v:.12e}" for v in np.asarray(rows, float)[:3].ravel())


class SemanticKitti:
    """Writes one sequence scan by scan into a folder; `close` writes what spans the scans.

    Points are written as the scan has them: in the sensor frame at the stamp when the scenario
    deskews (the default). Poses are of camera 0 relative to its first: T = Tr T_0^-1 T_k Tr^-1.
    The upper 16 bits of a label are the instance, numbered from 1 in the order of appearance and
    the same through the sequence; 0 for what is no actor.

    Args:
        folder: of the sequence, e.g. sequences/00; made here.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._first: F64 | None = None
        self._poses: list[str] = []
        self._times: list[str] = []
        self._start = 0.0
        self._instances: dict[int, int] = {}
        (folder / "velodyne").mkdir(parents=True)
        (folder / "labels").mkdir()

    def add(self, scan: Scan, truth: Truth) -> None:
        """Write one scan with its labels.

        Raises:
            OutputError: more instances than 16 bits can number.
        """
        if self._first is None:
            self._first, self._start = inverse(scan.T_world_sensor), scan.stamp
        name = f"{len(self._poses):06d}"
        rows = np.column_stack([scan.points, scan.intensity]).astype("<f4")
        (self._folder / "velodyne" / f"{name}.bin").write_bytes(rows.tobytes())
        label = semantic_classes(truth) | (self._instance(truth) << 16)
        (self._folder / "labels" / f"{name}.label").write_bytes(label.astype("<u4").tobytes())
        T_cam0_cam = T_CAM_VELO @ self._first @ scan.T_world_sensor @ inverse(T_CAM_VELO)
        self._poses.append(numbers(T_cam0_cam))
        self._times.append(f"{scan.stamp - self._start:.6e}")

    def close(self) -> None:
        """Write poses.txt, calib.txt and times.txt."""
        calib = [f"P{i}: {numbers(PROJECTION)}" for i in range(4)] + [f"Tr: {numbers(T_CAM_VELO)}"]
        for name, lines in {"poses": self._poses, "calib": calib, "times": self._times}.items():
            (self._folder / f"{name}.txt").write_text("".join(line + "\n" for line in lines))

    def _instance(self, truth: Truth) -> Array:
        """Instance (n,) uint32 of each return."""
        for identity in truth.boxes.id.tolist():
            self._instances.setdefault(identity, len(self._instances) + 1)
        if len(self._instances) > 0xFFFF:
            raise OutputError(
                f"{len(self._instances)} actors in one sequence; labels number 65535; generate fewer frames"
            )
        of_box = np.array([0, *(self._instances[i] for i in truth.boxes.id.tolist())], np.uint32)
        return of_box[truth.actor + 1]
