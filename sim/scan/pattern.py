"""The firing pattern of one sweep: origin, direction and time of each ray, in the sensor's frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from sim.scan.hdl64 import Unit

FIRINGS_PER_SECOND = 20833


@dataclass(frozen=True, eq=False)
class Pattern:
    """64 x C rays; ring 0 is the top, columns are in firing order.

    Attributes:
        period: duration of the sweep [s].
        time: (C,) of each column relative to the stamp [s]; the last fires at 0.
        rotor: (C,) azimuth of the head [rad, counter-clockwise]; it starts at the rear and turns
            clockwise seen from above, back at the rear at the stamp.
        azimuth: (64,) correction of each ring [rad]; a ray's azimuth is rotor + azimuth.
        elevation: (64,) [rad].
        origins: (64, C, 3) [m, sensor at the ray's own time], perpendicular to the ray.
        directions: (64, C, 3) unit [sensor at the ray's own time].
    """

    period: float
    time: F64
    rotor: F64
    azimuth: F64
    elevation: F64
    origins: F64
    directions: F64

    @property
    def columns(self) -> int:
        """C."""
        return len(self.time)


def columns(rate: float) -> int:
    """Columns of a sweep at `rate` [Hz]: 2083 at 10 Hz."""
    return round(FIRINGS_PER_SECOND / rate)


def pattern(unit: Unit, rate: float) -> Pattern:
    """The rays of `unit` spinning at `rate` [Hz] (equations in `Unit`)."""
    C, period = columns(rate), 1.0 / rate
    share = np.arange(1, C + 1) / C
    rotor = np.pi - 2 * np.pi * share
    V = unit.elevation[:, None]
    a = rotor[None, :] + unit.azimuth[:, None]
    v, h = unit.vertical_offset[:, None], unit.horizontal_offset[:, None]
    cos_a, sin_a = np.cos(a), np.sin(a)
    up = np.broadcast_to(np.sin(V), a.shape)
    directions = np.stack([np.cos(V) * cos_a, np.cos(V) * sin_a, up], -1)
    x = -v * np.sin(V) * cos_a - h * sin_a
    y = -v * np.sin(V) * sin_a + h * cos_a
    origins = np.stack([x, y, np.broadcast_to(v * np.cos(V), a.shape)], -1)
    return Pattern(period, period * (share - 1), rotor, unit.azimuth, unit.elevation, origins, directions)
