"""Real and simulated statistics side by side, each against its limit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.errors import ConfigError
from datmo.messages import Kind
from eval.compare.profile import BINS, Profile
from sim.scan.units import Unit

POINTS, MISSING, ELEVATION, INTENSITY, RANGES = 0.05, 0.03, 0.1, 0.05, 0.15
"""Most by which the simulated may differ: share of returns, share of firings, degrees, intensity, L1."""
RESIDUAL, DROP_OUTS = (0.007, 0.011), (0.005, 0.015)
"""Of real sweeps of the HDL-64E: noise on the road [m], share of isolated drop-outs."""
GROUP = 8
"""Rings whose missing share is taken together."""
SKY = np.arctan(1.73 / 80)
"""Rings that are flatter than this meet nothing on level ground; what they lack is the scene's [rad]."""
BY_KIND: Mapping[Kind, float] = {
    Kind.ROAD: 0.20,
    Kind.SIDEWALK: 0.30,
    Kind.FIELD: 0.34,
    Kind.VEGETATION: 0.32,
    Kind.BUILDING: 0.22,
    Kind.CAR: 0.05,
    Kind.SIGN: 0.40,
}
"""Mean intensity by class over ten labelled sweeps of KITTI, where the given sweeps have no labels."""


@dataclass(frozen=True)
class Line:
    """One statistic.

    Attributes:
        real, simulated: NaN where there is none. limit: in words. met: None where nothing is asked.
    """

    name: str
    unit: str
    real: float
    simulated: float
    limit: str = ""
    met: bool | None = None


def judge(real: Profile, simulated: Profile, unit: Unit, errors: F64) -> list[Line]:
    """Compare the means over real and over simulated sweeps.

    Args:
        unit: of the simulated sweeps. errors: (L,) see `elevation.errors` [deg].

    Raises:
        ConfigError: the numbers of rings differ.
    """
    if len(real.missing) != len(simulated.missing):
        raise ConfigError(
            f"the real sweeps have {len(real.missing)} rings, {unit.name} has {len(simulated.missing)}; "
            "choose the unit with --set sensor.unit=..."
        )
    return [
        _share("returns a sweep", real.points, simulated.points),
        Line("firings of a laser a sweep", "", real.columns, simulated.columns),
        *_missing(real, simulated, unit),
        _elevation(errors),
        _between("noise of range on the road", "m", real.residual, simulated.residual, RESIDUAL),
        _between("isolated drop-outs", "", real.drop_outs, simulated.drop_outs, DROP_OUTS),
        *_ranges(real, simulated),
        *_by_kind(real, simulated),
        Line("intensity, mean", "", real.intensity, simulated.intensity),
        Line("intensity of 0", "", real.zeros, simulated.zeros),
    ]


def _share(name: str, real: float, simulated: float) -> Line:
    met = abs(simulated - real) <= POINTS * real
    return Line(name, "", real, simulated, f"within {POINTS:.0%}", bool(met))


def _between(name: str, unit: str, real: float, simulated: float, limits: tuple[float, float]) -> Line:
    low, high = limits
    return Line(name, unit, real, simulated, f"{low:g} to {high:g}", bool(low <= simulated <= high))


def _missing(real: Profile, simulated: Profile, unit: Unit) -> Iterator[Line]:
    ground = np.flatnonzero(unit.elevation < -SKY)
    sky = np.flatnonzero(unit.elevation >= -SKY)
    if len(sky):
        name = f"missing, rings 0-{sky[-1]} (sky)"
        yield Line(name, "", float(real.missing[sky].mean()), float(simulated.missing[sky].mean()))
    for first in range(0, unit.rings, GROUP):
        rows = ground[(ground >= first) & (ground < first + GROUP)]
        if len(rows):
            a, b = float(real.missing[rows].mean()), float(simulated.missing[rows].mean())
            name = f"missing, rings {rows[0]}-{rows[-1]}"
            yield Line(name, "", a, b, f"within {MISSING:g}", abs(a - b) <= MISSING)


def _elevation(errors: F64) -> Line:
    worst = float(np.nanmax(np.abs(errors)))
    name = "elevation off the unit's table, worst ring"
    return Line(name, "deg", float("nan"), worst, f"at most {ELEVATION:g}", worst <= ELEVATION)


def _ranges(real: Profile, simulated: Profile) -> Iterator[Line]:
    for i in range(len(BINS) - 1):
        name = f"returns at {BINS[i]:.0f}-{BINS[i + 1]:.0f} m"
        yield Line(name, "", float(real.ranges[i]), float(simulated.ranges[i]))
    off = float(np.abs(real.ranges - simulated.ranges).sum())
    yield Line("range histogram, L1", "", float("nan"), off, f"at most {RANGES:g}", off <= RANGES)


def _by_kind(real: Profile, simulated: Profile) -> Iterator[Line]:
    for kind, usual in BY_KIND.items():
        a, b = real.by_kind.get(kind, usual), simulated.by_kind.get(kind, float("nan"))
        name = f"intensity, {kind.name.lower()}"
        yield Line(name, "", a, b, f"within {INTENSITY:g}", bool(abs(a - b) <= INTENSITY))
