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
    is near and few points are tested (see `distances`).
    """
    ring = np.zeros(len(points), np.int32)
    last, now = 0.0, 0
    for i in range(len(points)):
        azimuth = np.arctan2(np.float64(points[i, 1]), np.float64(points[i, 0])) % (2 * np.pi)
        if last - azimuth > np.pi:
            now += 1
        last = azimuth if np.isfinite(azimuth) else last
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
    for k in range(len(at)):
        i, best = at[k], np.inf
        for o in range(max(k - side, 0), min(k + side + 1, len(at))):
            j = at[o]
            if o != k and ring[i] == ring[j]:
                dx, dy = points[i, 0] - points[j, 0], points[i, 1] - points[j, 1]
                dz = points[i, 2] - points[j, 2]
                best = min(best, dx * dx + dy * dy + dz * dz)
        if best < np.inf:
            x, y, z = points[i, 0], points[i, 1], points[i, 2]
            out[i] = np.sqrt(best / max(x * x + y * y + z * z, TINY))
    return out


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
    known = np.isfinite(nearest)
    if not known.any():
        return keep
    spread = nearest[known].astype(float)
    limit = max(c.slack, float(spread.mean() + c.deviations * spread.std()))
    # NaN compares False: a return without a neighbour is kept.
    return np.asarray(keep & ~(nearest > limit))
