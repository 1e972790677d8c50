"""Real HDL-64E units: where each of the 64 lasers of a calibrated sensor sits and points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

from datmo.arrays import F64
from datmo.errors import ScenarioError, nearest

NAMES = ("hdl64e-s2.1-sztaki", "hdl64e-s3-20171102", "hdl64e-s3-xiesc", "hdl64e-utexas")
RINGS = 64


@dataclass(frozen=True, eq=False)
class Unit:
    """One calibrated sensor; row r is ring r, ring 0 the top by elevation.

    The sensor frame is the frame of the calibration: its origin lies on the axis of rotation,
    some 0.2 m below the optical centre (`vertical_offset`), and a measured distance d is counted
    from the foot of the perpendicular from that origin onto the beam. This is ROS's velodyne
    driver (rawdata.cc), with V the elevation, a the counter-clockwise azimuth of the beam, v and
    h the offsets:
        x = (d cos V - v sin V) cos a - h sin a
        y = (d cos V - v sin V) sin a + h cos a
        z = d sin V + v cos V
    KITTI's clouds are in this frame: a line z = x tan V + v / cos V fitted to each ring of a real
    sweep gives v = 0.21 m in the upper block, as in the tables here. Seen from the origin at
    street distances the top ring therefore stands at +2.4 degrees, not at its V of +1.9. The
    1.73 m of KITTI's sensor height is the height of this origin.

    Attributes:
        name: of the unit.
        elevation: (64,) V [rad], falling.
        azimuth: (64,) correction, a = rotor + azimuth, counter-clockwise from above [rad].
        vertical_offset: (64,) v [m]. horizontal_offset: (64,) h [m], to the left of the beam.
    """

    name: str
    elevation: F64
    azimuth: F64
    vertical_offset: F64
    horizontal_offset: F64


def unit_names() -> tuple[str, ...]:
    """The units there are."""
    return NAMES


@cache
def unit(name: str) -> Unit:
    """The unit called `name`, from its table (source in the table's first line).

    Raises:
        ScenarioError: there is no such unit.
    """
    if name not in NAMES:
        raise ScenarioError(f"sensor.unit {name!r} is no calibrated unit; {nearest(name, NAMES)}")
    text = files("sim.scan").joinpath("data", f"{name}.csv").read_text(encoding="utf-8")
    rows = [line for line in text.splitlines() if line and not line.startswith("#")]
    table = np.array([[float(value) for value in row.split(",")] for row in rows[1:]])
    table.setflags(write=False)
    return Unit(name, table[:, 1], table[:, 2], table[:, 3], table[:, 4])
