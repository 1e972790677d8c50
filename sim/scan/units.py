"""Real lidars as data: where each laser of a unit sits and points, and how often it fires."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from datmo.arrays import F64
from datmo.errors import ScenarioError, nearest

COLUMNS = ("laser", "elevation", "azimuth", "vertical_offset", "horizontal_offset")
FOCUS = "focus"
"""A column more, which a table may have."""
FACTS = {"firings": 1.0, "encoder": 360.0, "nearest": 0.0, "farthest": 1.0}
"""What the header of a table must say, and the least it may be."""
MOST_RINGS = 256  # the ring of a return is a uint8
STEEPEST = np.pi / 2


@dataclass(frozen=True, eq=False)
class Unit:
    """One sensor; row r is ring r, ring 0 the top by elevation.

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
        elevation: (L,) V [rad], falling.
        azimuth: (L,) correction, a = rotor + azimuth, counter-clockwise from above [rad].
        vertical_offset: (L,) v [m]. horizontal_offset: (L,) h [m], to the left of the beam.
        focus: (L,) distance to which each receiver is focused [m], None where the table does not say.
        firings: of each laser in a second.
        encoder: positions in a turn at which the head's azimuth is read.
        nearest, farthest: what it measures [m]. source: of its table.
    """

    name: str
    elevation: F64
    azimuth: F64
    vertical_offset: F64
    horizontal_offset: F64
    focus: F64 | None = None
    firings: int = 20833
    encoder: int = 4000
    nearest: float = 0.9
    farthest: float = 120.0
    source: str = ""

    @property
    def rings(self) -> int:
        """L."""
        return len(self.elevation)

    def columns(self, rate: float) -> int:
        """Firings of each laser in a sweep at `rate` [Hz]: 2083 for an HDL-64E at 10 Hz."""
        return round(self.firings / rate)


@cache
def unit_names() -> tuple[str, ...]:
    """The units that come with the project."""
    tables = files("sim.scan").joinpath("data").iterdir()
    return tuple(sorted(t.name.removesuffix(".csv") for t in tables if t.name.endswith(".csv")))


@cache
def unit(name: str) -> Unit:
    """A unit that comes with the project, by name, or one's own, by the path of its table (*.csv).

    A table starts with lines `# key: value` (source, firings, encoder, nearest, farthest), then a line of
    column names (`COLUMNS`) and one line a laser, from the top by elevation.

    Raises:
        ScenarioError: there is no such unit, or its table is wrong: a laser missing or twice, lasers
            out of order, numbers that are none or impossible.
    """
    if name in unit_names():
        text = files("sim.scan").joinpath("data", f"{name}.csv").read_text(encoding="utf-8")
        return read_unit(name, text)
    path = Path(name)
    if path.suffix == ".csv" and path.is_file():
        return read_unit(name, path.read_text(encoding="utf-8"))
    raise ScenarioError(
        f"sensor.unit {name!r} is no unit, nor a table of your own (a path that ends in .csv); "
        f"{nearest(name, unit_names())}"
    )


def read_unit(name: str, text: str) -> Unit:
    """The unit that a table describes; see `unit`."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    header = [line[1:].partition(":") for line in lines if line.startswith("#")]
    facts = {key.strip(): value.strip() for key, _, value in header}
    rows = [line for line in lines if not line.startswith("#")]
    heads = tuple(rows[0].split(",")) if rows else ()
    if heads not in (COLUMNS, (*COLUMNS, FOCUS)):
        told = rows[0] if rows else "missing"
        raise _wrong(name, f"its columns are {told}", f"must be {','.join(COLUMNS)}, and may end in {FOCUS}")
    table = _numbers(name, rows[1:], len(heads))
    _check_lasers(name, table)
    table.setflags(write=False)
    number = {key: _fact(name, facts, key, least) for key, least in FACTS.items()}
    return Unit(
        name,
        elevation=table[:, 1],
        azimuth=table[:, 2],
        vertical_offset=table[:, 3],
        horizontal_offset=table[:, 4],
        focus=table[:, 5] if heads[-1] == FOCUS else None,
        firings=round(number["firings"]),
        encoder=round(number["encoder"]),
        nearest=number["nearest"],
        farthest=number["farthest"],
        source=facts.get("source", "not said"),
    )


def _numbers(name: str, rows: list[str], width: int) -> F64:
    """The rows of a table (L, width)."""
    table = []
    for i, row in enumerate(rows, start=1):
        try:
            values = [float(value) for value in row.split(",")]
        except ValueError:
            values = []
        if len(values) != width or not np.isfinite(values).all():
            raise _wrong(name, f"row {i} is {row!r}", f"a row is {width} finite numbers")
        table.append(values)
    if not 1 <= len(table) <= MOST_RINGS:
        raise _wrong(name, f"it has {len(table)} lasers", f"a unit has 1 to {MOST_RINGS}")
    return np.array(table)


def _check_lasers(name: str, table: F64) -> None:
    """Every laser once, from the top down, at elevations and offsets that can be."""
    laser, elevation = table[:, 0].tolist(), table[:, 1]
    twice = sorted({int(i) for i in laser if laser.count(i) > 1})
    if twice:
        raise _wrong(
            name, f"laser {twice[0]} is there {laser.count(twice[0])} times", "each laser has one row"
        )
    gone = sorted(set(range(int(min(laser)), int(min(laser)) + len(laser))) - {int(i) for i in laser})
    if gone:
        raise _wrong(name, f"laser {gone[0]} is missing", "lasers are numbered without gaps")
    rising = np.flatnonzero(np.diff(elevation) >= 0)
    if len(rising):
        raise _wrong(
            name,
            f"row {rising[0] + 2} has elevation {elevation[rising[0] + 1]:.4f} rad after "
            f"{elevation[rising[0]]:.4f}",
            "rows go from the top laser down; sort them, and give no elevation twice",
        )
    if np.abs(elevation).max() >= STEEPEST or np.abs(table[:, 2]).max() > np.pi:
        raise _wrong(name, "an angle is beyond a quarter turn", "angles are in radians, not degrees")
    if np.abs(table[:, 3:5]).max() > 1.0:
        raise _wrong(
            name, f"an offset is {np.abs(table[:, 3:5]).max():g} m", "offsets are in metres, below 1"
        )
    if table.shape[1] > len(COLUMNS) and table[:, 5].min() <= 0:
        raise _wrong(name, f"a focus is {table[:, 5].min():g} m", "it is above 0")


def _fact(name: str, facts: dict[str, str], key: str, least: float) -> float:
    """A number of the header."""
    try:
        value = float(facts[key])
    except (KeyError, ValueError):
        raise _wrong(name, f"its header says {key}: {facts.get(key)}", f"write '# {key}: <number>'") from None
    if not np.isfinite(value) or value < least:
        raise _wrong(name, f"its header says {key}: {value:g}", f"it is at least {least:g}")
    return value


def _wrong(name: str, value: str, rule: str) -> ScenarioError:
    return ScenarioError(f"the sensor table {name!r}: {value}; {rule}; mend the table")
