"""Sight: how far the rays of a scan saw, by azimuth and elevation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, F64, I64
from datmo.geometry import inverse, transform
from datmo.messages.base import Message

AZIMUTH_STEP = np.deg2rad(0.5)
ELEVATION_STEP = np.deg2rad(0.5)
LOWEST, HIGHEST = np.deg2rad(-26.0), np.deg2rad(4.0)


@dataclass(frozen=True, eq=False)
class Sight(Message):
    """Nearest and farthest return in each direction, in the sensor frame of one scan.

    Attributes:
        near: (e, a) nearest range in the cell [m], 0 where no ray returned.
        far: (e, a) farthest range in the cell [m], 0 where no ray returned.
        T_world_sensor: (4, 4).
        dt: (a,) when the rays of each column were fired, before the scan's stamp [s, <= 0]; 0 where left out.

    Rows run up from `LOWEST` by `ELEVATION_STEP`; columns run counter-clockwise from azimuth
    -pi by `AZIMUTH_STEP`.
    """

    near: F32
    far: F32
    T_world_sensor: F64
    dt: F32 = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        self._set("near", (None, None), np.float32)
        self._set("far", self.near.shape, np.float32)
        self._set("T_world_sensor", (4, 4), np.float64)
        self._set("dt", (self.near.shape[1],), np.float32, 0)

    def look(self, places: F64) -> tuple[F64, F64, F64]:
        """What the scan saw in the direction of each place.

        Args:
            places: (n, 3) [m, world].

        Returns:
            distance (n,) from the sensor to the place, and the nearest and farthest range seen
            in its direction, (n,) each [m], NaN where no ray returned or none was fired.
        """
        local = transform(inverse(self.T_world_sensor), np.atleast_2d(places))
        distance = np.linalg.norm(local, axis=1)
        row, column = cells(local, self.near.shape)
        fired = (row >= 0) & (row < self.near.shape[0])
        row = np.clip(row, 0, self.near.shape[0] - 1)
        near, far = self.near[row, column].astype(float), self.far[row, column].astype(float)
        seen = fired & (far > 0)
        return distance, np.where(seen, near, np.nan), np.where(seen, far, np.nan)

    def when(self, places: F64) -> F64:
        """When the rays towards each place (n, 2 or 3) [m, world] were fired: (n,) [s, <= 0]."""
        local = np.zeros((len(places), 3))
        local[:, : places.shape[1]] = places
        local[:, 2] = self.T_world_sensor[2, 3]
        column = cells(transform(inverse(self.T_world_sensor), local), self.near.shape)[1]
        return self.dt[column].astype(float)


def cells(points: F64, shape: tuple[int, ...]) -> tuple[I64, I64]:
    """Row and column of each point (n, 3) [m, sensor]; rows may lie outside `shape`."""
    azimuth = np.arctan2(points[:, 1], points[:, 0])
    elevation = np.arctan2(points[:, 2], np.hypot(points[:, 0], points[:, 1]))
    row = np.floor((elevation - LOWEST) / ELEVATION_STEP).astype(np.int64)
    column = np.floor((azimuth + np.pi) / AZIMUTH_STEP).astype(np.int64) % shape[1]
    return row, column
