"""What can be measured on one sweep of a spinning lidar from its points alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from datmo.arrays import F32, F64, U8, Bool
from datmo.errors import ConfigError
from datmo.messages import Kind
from eval.compare.noise import residuals

BINS = (0.0, 5.0, 10.0, 20.0, 30.0, 40.0, 60.0, 80.0)
"""Of the histogram of range [m]."""
NEAR = 15.0
"""The road's residual is taken up to here [m]."""
LONE = (1.5, 2.6)
"""A gap of so many steps between two returns of a ring is one lost firing: the azimuth of real sweeps
comes in steps of 0.09 degrees, so that one step is 0.09 or 0.18 and two are 0.27 to 0.36."""
FEWEST = 50
"""Points of a class, or of a ring, that make a mean."""
SMOOTH = 0.25
"""A stretch is on the road if its mean height is so near that of the ground about the sensor [m]."""
NUMBERS = ("points", "columns", "residual", "drop_outs", "zeros", "intensity")
ARRAYS = ("missing", "elevation", "ranges")


@dataclass(frozen=True, eq=False)
class Profile:
    """Statistics of one sweep, or means over several.

    Attributes:
        points: returns. columns: firings of each laser, from the mean azimuth step.
        missing: (L,) share of each ring's firings without a return.
        elevation: (L,) median of each ring, seen from the origin [deg], NaN where returns are few.
        residual: of range on the road nearer than `NEAR` [m]: root of the mean square about a parabola
            through 11 neighbouring returns. drop_outs: firings lost alone, share of returns.
        zeros: share of intensities that are 0. intensity: mean. by_kind: mean of each labelled class.
        ranges: (7,) share of returns in each of `BINS`.
    """

    points: float
    columns: float
    missing: F64
    elevation: F64
    residual: float
    drop_outs: float
    zeros: float
    intensity: float
    ranges: F64
    by_kind: Mapping[Kind, float] = field(default_factory=dict)


def profile(points: F32, intensity: F32, ring: U8, kind: U8 | None = None) -> Profile:
    """Measure one sweep.

    Args:
        points: (n, 3) [m, sensor], ring by ring in firing order. intensity: (n,). ring: (n,).
        kind: (n,) of each point, where it is known.

    Raises:
        ConfigError: too few points to tell anything.
    """
    if len(points) < 1000:
        raise ConfigError(
            f"a cloud of {len(points)} points is no sweep; give full sweeps of a spinning lidar"
        )
    xyz = np.asarray(points, float)
    distance = np.sqrt(np.einsum("ij,ij->i", xyz, xyz))
    turn, same = _turns(xyz, ring)
    step = float(turn[same & (turn < 1.6 * np.median(turn[same]))].mean())
    rings = int(ring.max()) + 1
    count = np.bincount(ring, minlength=rings)
    columns = 2 * np.pi / step
    alone = same & (turn > LONE[0] * step) & (turn < LONE[1] * step)
    return Profile(
        points=len(xyz),
        columns=columns,
        missing=np.clip(1 - count / columns, 0, 1),
        elevation=_elevations(xyz, ring, rings),
        residual=_residual(xyz, distance, ring, turn, step),
        drop_outs=float(alone.sum() / len(xyz)),
        zeros=float((intensity == 0).mean()),
        intensity=float(intensity.mean()),
        ranges=np.histogram(distance, BINS)[0] / len(xyz),
        by_kind={} if kind is None else _by_kind(intensity, kind),
    )


def _turns(xyz: F64, ring: U8) -> tuple[F64, Bool]:
    """Angle between each return and the next (n - 1,) [rad], and whether both are of one ring."""
    azimuth = np.arctan2(xyz[:, 1], xyz[:, 0])
    turn = np.abs(np.angle(np.exp(1j * np.diff(azimuth))))
    return turn, np.asarray(np.diff(ring.astype(int)) == 0)


def _elevations(xyz: F64, ring: U8, rings: int) -> F64:
    angle = np.degrees(np.arctan2(xyz[:, 2], np.hypot(xyz[:, 0], xyz[:, 1])))
    each = [angle[ring == r] for r in range(rings)]
    return np.array([np.median(a) if len(a) >= FEWEST else np.nan for a in each])


def _residual(xyz: F64, distance: F64, ring: U8, turn: F64, step: float) -> float:
    """Noise of range on the road, of the middle half of all stretches: the others have edges."""
    error, rows = residuals(distance, ring, turn, step)
    ground = float(np.median(xyz[(distance > 5) & (distance < 10), 2]))
    level = np.abs(xyz[rows].mean(1)[:, 2] - ground) < SMOOTH
    near = distance[rows].mean(1) < NEAR
    return float(np.sqrt(np.median(error[level & near] ** 2))) if (level & near).any() else float("nan")


def _by_kind(intensity: F32, kind: U8) -> dict[Kind, float]:
    known = [k for k in Kind if (kind == k).sum() >= FEWEST]
    return {k: float(intensity[kind == k].mean()) for k in known}


def mean(profiles: Sequence[Profile]) -> Profile:
    """The mean of several sweeps' statistics; what some sweeps lack is that of the others.

    Raises:
        ConfigError: the sweeps are of lidars with different numbers of rings.
    """
    rings = {len(p.missing) for p in profiles}
    if len(rings) > 1:
        raise ConfigError(f"sweeps of {sorted(rings)} rings; compare sweeps of one kind of lidar")
    rows = [p.__dict__ for p in profiles]
    numbers: dict[str, Any] = {n: float(_mean(np.array([r[n] for r in rows]))) for n in NUMBERS}
    arrays: dict[str, Any] = {n: _mean(np.array([r[n] for r in rows])) for n in ARRAYS}
    kinds = sorted({k for p in profiles for k in p.by_kind})
    by_kind = {k: float(np.mean([p.by_kind[k] for p in profiles if k in p.by_kind])) for k in kinds}
    return Profile(**numbers, **arrays, by_kind=by_kind)


def _mean(values: F64) -> F64:
    """Over the first axis, without what is NaN; NaN where all are."""
    known = np.isfinite(values)
    total, count = np.where(known, values, 0).sum(0), known.sum(0)
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1), np.nan))
