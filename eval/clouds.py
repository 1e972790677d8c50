"""Cloud files: reading KITTI's .bin, writing SemanticKITTI's .label and boxes as JSON."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from datmo.arrays import F32, I64, Array, Bool
from datmo.errors import CloudFileError
from datmo.messages import Boxes, Clusters, Kind, Scan

POINT_BYTES = 16
ROAD, OTHER_OBJECT, UNLABELLED = 40, 99, 0
"""SemanticKITTI's ids that a label file of ours holds: ground, not ground, dropped."""


@dataclass(frozen=True)
class Cloud:
    """A cloud as read.

    Attributes:
        scan: the points with finite numbers, in the order of the file.
        kept: (n,) which points of the file these are.
    """

    scan: Scan
    kept: Bool

    @property
    def dropped(self) -> int:
        """Points of the file with NaN or infinite numbers."""
        return int(np.count_nonzero(~self.kept))


def read_bin(path: Path) -> Cloud:
    """A cloud of float32 x, y, z, intensity [m, sensor], as KITTI's velodyne files hold it.

    Points with a number that is not finite are dropped and counted; intensity is cut to 0..1
    (a NaN intensity becomes 0).

    Raises:
        CloudFileError: no such file, a folder, empty, a size that is no multiple of 16 bytes, or
            no point with finite coordinates.
    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise CloudFileError(f"{path}: no such file; give a .bin of float32 x, y, z, intensity") from None
    except IsADirectoryError:
        raise CloudFileError(f"{path} is a folder; give one .bin file in it") from None
    except OSError as error:
        raise CloudFileError(f"{path} cannot be read: {error.strerror}; give a readable .bin") from None
    if not data:
        raise CloudFileError(f"{path} is empty; a cloud has at least one point of 16 bytes")
    if len(data) % POINT_BYTES:
        raise CloudFileError(
            f"{path} has {len(data)} bytes, no multiple of {POINT_BYTES} (float32 x, y, z, intensity); "
            "it is cut short or of another format; copy it again or convert it"
        )
    rows: F32 = np.frombuffer(data, "<f4").reshape(-1, 4).astype(np.float32)
    kept = np.asarray(np.isfinite(rows[:, :3]).all(axis=1))
    if not kept.any():
        raise CloudFileError(f"{path}: none of its {len(rows)} points is finite; give another file")
    rows = rows[kept]
    intensity = np.clip(np.nan_to_num(rows[:, 3], nan=0.0, posinf=1.0, neginf=0.0), 0, 1)
    return Cloud(Scan(points=rows[:, :3], intensity=intensity), kept)


def labels(is_ground: Bool, kept: Bool) -> Array:
    """Labels (n,) uint32 of every point of the file: 40 ground, 99 not ground, 0 dropped.

    Args:
        is_ground: of the points kept, in their order. kept: (n,) of the points of the file.
    """
    out = np.full(len(kept), UNLABELLED, np.uint32)
    out[kept] = np.where(is_ground, ROAD, OTHER_OBJECT)
    return out


def label_bytes(label: Array) -> bytes:
    """The content of a SemanticKITTI .label file: little-endian uint32."""
    return label.astype("<u4").tobytes()


def cluster_sizes(boxes: Boxes, scan: Scan, clusters: Clusters) -> I64:
    """Points (k,) of clusters inside each box, seen from above with a margin of 0.2 m."""
    rows = np.flatnonzero(clusters.label >= 0)
    xy = scan.points[rows, :2].astype(float) @ scan.T_world_sensor[:2, :2].T
    xy += scan.points[rows, 2:3].astype(float) * scan.T_world_sensor[:2, 2] + scan.T_world_sensor[:2, 3]
    counts = np.zeros(len(boxes), np.int64)
    for i in range(len(boxes)):
        offset = xy - boxes.center[i, :2]
        c, s = np.cos(boxes.yaw[i]), np.sin(boxes.yaw[i])
        along, across = (
            np.abs(c * offset[:, 0] + s * offset[:, 1]),
            np.abs(c * offset[:, 1] - s * offset[:, 0]),
        )
        half = boxes.size[i, :2] / 2 + 0.2
        counts[i] = np.count_nonzero((along <= half[0]) & (across <= half[1]))
    return counts


def boxes_json(boxes: Boxes, points: I64, source: str, dropped: int) -> str:
    """The text of boxes.json: one object a box, in the frame of the sensor.

    Args:
        boxes: detections. points: (k,) in each. source: name of the cloud. dropped: points left out.
    """
    content = {
        "cloud": source,
        "frame": "sensor: x forward, y left, z up [m]",
        "dropped_points": dropped,
        "boxes": [
            {
                "center": [round(float(v), 4) for v in boxes.center[i]],
                "size": [round(float(v), 4) for v in boxes.size[i]],
                "yaw": round(float(boxes.yaw[i]), 5),
                "score": round(float(boxes.score[i]), 4),
                "kind": Kind(int(boxes.kind[i])).name.lower(),
                "points": int(points[i]),
            }
            for i in range(len(boxes))
        ],
    }
    return json.dumps(content, indent=1, allow_nan=False) + "\n"
