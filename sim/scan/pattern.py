"""The firing pattern of one sweep: origin, direction and time of each ray, in the sensor's frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from sim.scan.units import Unit


@dataclass(frozen=True, eq=False)
class Pattern:
    """L x C rays; ring 0 is the top, columns are in firing order.

    Attributes:
        period: duration of the sweep [s].
        time: (C,) of each column relative to the stamp [s]; the last fires at 0.
        rotor: (C,) azimuth of the head [rad, counter-clockwise]; it starts at the rear and turns
            clockwise seen from above, back at the rear at the stamp.
        azimuth: (L,) correction of each ring [rad]; a ray's azimuth is rotor + azimuth.
        elevation: (L,) [rad].
        origins: (L, C, 3) [m, sensor at the ray's own time], perpendicular to the ray.
        directions: (L, C, 3) unit [sensor at the ray's own time].
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


def pattern(unit: Unit, rate: float, encoder: bool = True) -> Pattern:
    """The rays of `unit` spinning at `rate` [Hz] (equations in `Unit`).

    A laser fires at even times, and its azimuth is read at the nearest position of the encoder: steps
    are uneven, multiples of 0.09 degrees for an HDL-64E (0.18 and 0.09 in real sweeps).

    Args:
        encoder: False for even steps.
    """
    C, period = unit.columns(rate), 1.0 / rate
    share = np.arange(1, C + 1) / C
    turned = np.round(share * unit.encoder) / unit.encoder if encoder else share
    rotor = np.pi - 2 * np.pi * turned
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
