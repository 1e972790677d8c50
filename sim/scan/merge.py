"""Who won each ray: the nearest hit, the count of rays won and lost, and the surface's normal."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32
from sim.scene.motion import BLOCK

NOTHING, TERRAIN, THING = -1, -2, -3

Found = tuple[F32, I32, I32, F32, F32]
"""Per ray: distance, winner, triangle, normal and cosine, as in `sim.scan.caster.Hits`."""
View = tuple[F64, F64, F64, F64]
"""Directions [sensor], T_world_sensor, T_stamp_sensor and weight of each column."""


@njit(cache=True, nogil=True)
def nearer(
    name: int, hit: tuple[F32, I32, F32], distance: F32, winner: I32, triangle: I32, normal: F32
) -> None:
    """Give `name` the rays on which it was hit nearer than `distance`, or where nothing was met yet.

    Args:
        hit: distance, triangle (-1 none) and normal [world] of each ray.
    """
    for r in range(len(distance)):
        d = hit[0][r]
        if hit[1][r] >= 0 and (d < distance[r] or winner[r] == NOTHING):
            distance[r], winner[r], triangle[r] = d, name, hit[1][r]
            for i in range(3):
                normal[r, i] = hit[2][r, i]


@njit(cache=True, nogil=True)
def _face(
    r: int, d: F64, T_ws: F64, T_stamp: F64, x: float, y: float, z: float, normal: F32, cosine: F32
) -> None:
    """Write the normal (x, y, z) [world] of what ray r met, and the cosine of its incidence.

    The normal becomes unit, faces the sensor and is in its frame at the stamp. (Whole arrays and
    an index: a view of a row costs more than all the sums here.)
    """
    C = d.shape[1]
    ring = r // C
    c = r - ring * C
    u = T_ws[c, 0, 0] * x + T_ws[c, 1, 0] * y + T_ws[c, 2, 0] * z
    v = T_ws[c, 0, 1] * x + T_ws[c, 1, 1] * y + T_ws[c, 2, 1] * z
    w = T_ws[c, 0, 2] * x + T_ws[c, 1, 2] * y + T_ws[c, 2, 2] * z
    size = np.sqrt(u * u + v * v + w * w)
    along = (u * d[ring, c, 0] + v * d[ring, c, 1] + w * d[ring, c, 2]) / size
    cosine[r] = min(abs(along), 1.0)
    s = -1.0 / size if along > 0 else 1.0 / size
    for i in range(3):
        normal[r, i] = s * (T_stamp[c, i, 0] * u + T_stamp[c, i, 1] * v + T_stamp[c, i, 2] * w)


@njit(cache=True, nogil=True)
def describe(start: int, stop: int, view: View, found: Found) -> None:
    """Describe what stands still and was met by rays start..stop: normals [world] become those of `Hits`.

    Rays that met nothing get an infinite distance, and no normal.
    """
    distance, winner, triangle, normal, cosine = found
    d, T_ws, T_stamp, _ = view
    for r in range(start, stop):
        if winner[r] >= 0:
            continue
        if winner[r] == NOTHING:
            distance[r], triangle[r], cosine[r] = np.inf, -1, 0.0
            for i in range(3):
                normal[r, i] = 0.0
            continue
        _face(r, d, T_ws, T_stamp, normal[r, 0], normal[r, 1], normal[r, 2], normal, cosine)


@njit(cache=True, nogil=True)
def contest(first: int, start: I32, ray: I32, hit: tuple[F32, I32], found: Found) -> None:
    """Give actors first, first + 1, ... the rays on which they are nearest so far.

    At a tie the earlier keeps the ray.

    Args:
        start: (k + 1,) rows of each actor in `ray` and `hit` (distance, triangle; -1 none).
    """
    distance, winner, triangle = found[0], found[1], found[2]
    far, at = hit
    for a in range(len(start) - 1):
        for n in range(start[a], start[a + 1]):
            r = ray[n]
            if at[n] >= 0 and (far[n] < distance[r] or winner[r] == NOTHING):
                distance[r], winner[r], triangle[r] = far[n], first + a, at[n]


@njit(cache=True, nogil=True)
def account(
    first: int,
    start: I32,
    ray: I32,
    hit: tuple[F32, I32, F32],
    T_wa: F64,
    view: View,
    min_range: float,
    found: Found,
    lost_to: I32,
) -> None:
    """Count who won the rays that hit actors first, first + 1, ..., and describe the rays they won.

    A hit nearer than `min_range` could not have been measured and is not counted.

    Args:
        hit: distance, triangle (-1 none) and normal [actor]. T_wa: (k, B + 1, 4, 4) of all actors.
        lost_to: (k, k + 2) counts; what an actor won itself stands on the diagonal.
    """
    winner, normal, cosine = found[1], found[3], found[4]
    (d, T_ws, T_stamp, weight), (distance, triangle, faces) = view, hit
    C, k, n = d.shape[1], len(T_wa), np.empty(3)
    for row in range(first, first + len(start) - 1):
        for m in range(start[row - first], start[row - first + 1]):
            if triangle[m] < 0:
                continue
            r = ray[m]
            by = winner[r]
            if distance[m] >= min_range:
                lost_to[row, k if by == THING else k + 1 if by == TERRAIN else by] += 1
            if by != row:
                continue
            b, w = r % C // BLOCK, weight[r % C]
            for i in range(3):
                n[i] = 0.0
                for j in range(3):
                    e = T_wa[row, b, i, j] + w * (T_wa[row, b + 1, i, j] - T_wa[row, b, i, j])
                    n[i] += e * faces[m, j]
            _face(r, d, T_ws, T_stamp, n[0], n[1], n[2], normal, cosine)
