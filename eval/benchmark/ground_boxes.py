"""Labelled boxes of KITTI's object folders, in the frame of the sensor."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from datmo.arrays import F32, F64, Bool
from datmo.errors import CloudFileError
from datmo.geometry import inverse
from eval.metrics.ground import FOOT

LABELLED = ("Car", "Van", "Truck", "Pedestrian", "Person_sitting")
"""Types of label that are vehicles or persons."""


@dataclass(frozen=True, eq=False)
class Labelled:
    """One labelled object: middle of its base (3,) [m, sensor], length, width, height [m], yaw [rad]."""

    base: F64
    size: tuple[float, float, float]
    yaw: float

    def above_foot(self, points: F32) -> Bool:
        """Which points (n, 3) [m, sensor] are inside, more than 0.1 m above the box's bottom."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        x, y, z = (points.astype(float) - self.base).T
        along, across = np.abs(c * x + s * y), np.abs(c * y - s * x)
        length, width, height = self.size
        return np.asarray((along <= length / 2) & (across <= width / 2) & (z > FOOT) & (z <= height))


def read_boxes(folder: Path) -> list[Labelled]:
    """The vehicles and persons of a folder with calib.txt and label_2.txt.

    Boxes of KITTI stand in the camera's frame (x right, y down, z forward), turned by ry about y.

    Raises:
        CloudFileError: a file is missing or of another form.
    """
    try:
        return list(_read(folder))
    except (OSError, ValueError, KeyError) as error:
        raise CloudFileError(
            f"{folder}: {error!r}; give a folder with calib.txt and label_2.txt as KITTI has them"
        ) from None


def _read(folder: Path) -> Iterator[Labelled]:
    lines = (folder / "calib.txt").read_text().splitlines()
    rows = dict(line.split(":") for line in lines if ":" in line)
    T_camera_sensor, R = np.eye(4), np.eye(4)
    T_camera_sensor[:3] = np.array(rows["Tr_velo_to_cam"].split(), float).reshape(3, 4)
    R[:3, :3] = np.array(rows["R0_rect"].split(), float).reshape(3, 3)
    T_sensor_camera = inverse(R @ T_camera_sensor)
    for line in (folder / "label_2.txt").read_text().splitlines():
        name, *values = line.split()
        if name in LABELLED:
            height, width, length, x, y, z, ry = map(float, values[7:14])
            ahead = T_sensor_camera[:3, :3] @ [np.cos(ry), 0.0, -np.sin(ry)]
            base = (T_sensor_camera @ [x, y, z, 1.0])[:3]
            yield Labelled(base, (length, width, height), float(np.arctan2(ahead[1], ahead[0])))
