"""Scan: one turn of the lidar."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, F64, U8
from datmo.errors import MessageError
from datmo.geometry import is_rigid
from datmo.messages.base import Message


@dataclass(frozen=True, eq=False)
class Scan(Message):
    """One sweep of a spinning lidar. `Scan(points=xyz)` suffices.

    Order of the rows: ring by ring from the top, each in firing order, as KITTI stores them.
    Points that are not finite are legal; perception leaves them out (see `datmo.refine`).

    Attributes:
        points: (n, 3) [m, sensor], at `stamp` when `deskewed`, else at each point's own time.
        stamp: end of the sweep [s].
        T_world_sensor: (4, 4) takes sensor coordinates at `stamp` to world.
        deskewed: whether the ego motion within the sweep has been taken out.
        intensity: (n,) 0..1.
        ring: (n,) 0 = top.
        dt: (n,) firing time relative to `stamp` [s], <= 0.

    Raises:
        MessageError: a field has the wrong shape or type, or the stamp or the pose is not finite.
    """

    points: F32
    stamp: float = 0.0
    T_world_sensor: F64 = None  # type: ignore[assignment]
    deskewed: bool = True
    intensity: F32 = None  # type: ignore[assignment]
    ring: U8 = None  # type: ignore[assignment]
    dt: F32 = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        self._set("points", (None, 3), np.float32)
        n = len(self.points)
        object.__setattr__(self, "stamp", float(self.stamp))
        self._set("T_world_sensor", (4, 4), np.float64, np.eye(4))
        self._set("intensity", (n,), np.float32, 0)
        self._set("ring", (n,), np.uint8, 0)
        self._set("dt", (n,), np.float32, 0)

        if not (np.isfinite(self.stamp) and np.isfinite(self.T_world_sensor).all()):
            raise MessageError(
                f"Scan has stamp {self.stamp} s and T_world_sensor {self.T_world_sensor.tolist()}; both must "
                "be finite; leave out scans without a time or a pose"
            )
        if not is_rigid(self.T_world_sensor):
            raise MessageError(
                f"Scan has T_world_sensor {self.T_world_sensor.tolist()}; it must be a rotation and a "
                "translation, with 0 0 0 1 below; give the sensor's pose in the world"
            )

    def __len__(self) -> int:
        return len(self.points)
