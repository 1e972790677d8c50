"""Refine: which points of a scan take part (method.md, 1)."""

from __future__ import annotations

import numba
import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from datmo import bins
from datmo.arrays import F32, I32, Bool
from datmo.messages import Scan

TINY = np.float32(1e-12)


class RefineConfig(BaseModel):
    """Frozen; an unknown key is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    radius: float = Field(bins.RADIUS, gt=0, description="B, points farther in x-y are dropped [m]")
    blind: float = Field(0.9, ge=0, description="points nearer to the sensor are dropped [m]")
    neighbours: int = Field(2, ge=0, le=8, description="returns looked at on each side; 0 skips the test")
    deviations: float = Field(6.0, gt=0, description="s, outlier beyond mean + s std of the distances")
    slack: float = Field(0.1, ge=0, description="never an outlier below this share of the range [m/m]")


@numba.njit(cache=True, nogil=True)
def inside(points: F32, blind: float, radius: float) -> Bool:
    """Points (n,) that are finite, at least `blind` away and less than `radius` away in x-y."""
    keep = np.zeros(len(points), np.bool_)
    for i in range(len(points)):
        x, y, z = np.float64(points[i, 0]), np.float64(points[i, 1]), np.float64(points[i, 2])
        flat = x * x + y * y
        # Comparisons with NaN are False, and an infinite z is not finite.
        keep[i] = flat < radius * radius and flat + z * z >= blind * blind and np.isfinite(z)
    return keep


@numba.njit(cache=True, nogil=True)
def rings_of(points: F32) -> I32:
    """Ring of each point (n,) of a cloud stored ring by ring, 0 = first, by where the azimuth jumps.

    In KITTI's files a ring runs anticlockwise from the x axis; a jump back of more than half a turn
    starts the next. A cloud in no such order gives meaningless rings; then none of its neighbours
    is near and few points are tested (see `distances`). Points without an azimuth are passed over.
    """
    ring = np.zeros(len(points), np.int32)
    last_x, last_y, now = 1.0, 0.0, 0
    for i in range(len(points)):
        x, y = np.float64(points[i, 0]), np.float64(points[i, 1])
        if 0 < x * x + y * y < np.inf:
            # From below the x axis to above it, anticlockwise by less than half a turn: the azimuth in
            # [0, 2 pi) fell by more than half a turn.
            if last_y < 0 and y >= 0 and last_x * y - last_y * x > 0:
                now += 1
            last_x, last_y = x, y
        ring[i] = now
    return ring


@numba.njit(cache=True, nogil=True)
def distances(points: F32, ring: I32, keep: Bool, side: int) -> F32:
    """Distance (n,) to the nearest of the `side` kept returns before and after on the same ring, as
    a share of the point's range [m/m]: that is how the spacing of returns grows.

    NaN for points not kept or without such a neighbour: nothing can be said of them.
    """
    out = np.full(len(points), np.nan, np.float32)
    at = np.flatnonzero(keep)
    square = np.full(len(at), np.inf, np.float32)
    for k in range(len(at)):
        i = at[k]
        for o in range(k + 1, min(k + side + 1, len(at))):  # each pair once; those before k are done
            j = at[o]
            if ring[i] == ring[j]:
                dx, dy = points[i, 0] - points[j, 0], points[i, 1] - points[j, 1]
                dz = points[i, 2] - points[j, 2]
                d = dx * dx + dy * dy + dz * dz
                square[k], square[o] = min(square[k], d), min(square[o], d)
        if square[k] < np.inf:
            x, y, z = points[i, 0], points[i, 1], points[i, 2]
            out[i] = np.sqrt(np.float64(square[k]) / max(x * x + y * y + z * z, TINY))
    return out


@numba.njit(cache=True, nogil=True)
def mean_and_std(values: F32) -> tuple[float, float]:
    """Of the values (n,) that are not NaN; NaN where there are none."""
    n, total, square = 0, 0.0, 0.0
    for i in range(len(values)):
        if not np.isnan(values[i]):
            n += 1
            total += values[i]
    if n == 0:
        return np.nan, np.nan
    mean = total / n
    for i in range(len(values)):
        if not np.isnan(values[i]):
            square += (values[i] - mean) ** 2
    return mean, np.sqrt(square / n)


def refine(scan: Scan, config: RefineConfig | None = None) -> Bool:
    """Which points (n,) of a scan take part.

    Dropped are points that are not finite, beyond the radius, inside the blind radius, or
    statistical outliers: their nearest neighbour among the adjacent returns of their ring lies
    farther than the mean + s std over the scan, and than `slack`, as a share of the range. (Neighbours in
    the range image cost a twentieth of a k-d tree; a return without any is kept.) Where
    `scan.ring` is all zeros, rings are told by the jumps of azimuth in the order of KITTI's files.

    Args:
        scan: the scan; its order of rows matters here, see `Scan`.
        config: None takes the defaults.
    """
    c = config or RefineConfig()
    keep = inside(scan.points, c.blind, c.radius)
    if c.neighbours == 0 or len(scan) == 0:
        return keep
    ring = scan.ring.astype(np.int32) if scan.ring.any() else rings_of(scan.points)
    nearest = distances(scan.points, ring, keep, c.neighbours)
    mean, std = mean_and_std(nearest)
    limit = max(c.slack, mean + c.deviations * std)
    # NaN compares False: a return without a neighbour is kept.
    return np.asarray(keep & ~(nearest > limit))
