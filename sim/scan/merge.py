"""Who won each ray: the nearest hit, the count of rays won and lost, and the surface's normal."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32
from sim.scan.embree import Casts
from sim.scan.motion import SweepMotion
from sim.scan.pattern import Pattern
from sim.scan.pool import spread
from sim.scene.motion import BLOCK

NOTHING, TERRAIN, THING = -1, -2, -3


def contest(row: int, ray: I32, casts: Casts, distance: F32, winner: I32, triangle: I32, normal: F32) -> None:
    """Give actor `row` the rays on which it is nearest so far; at a tie the earlier one keeps it.

    Changes `distance`, `winner`, `triangle` and `normal` (m, ...) in place; normals of actors are
    left in the actor frame.
    """
    beats = casts.distance < distance[ray]
    won = ray[beats]
    distance[won], winner[won] = casts.distance[beats], row
    triangle[won], normal[won] = casts.triangle[beats], casts.normal[beats]


def account(
    rays: Sequence[I32], distances: Sequence[F32], winner: I32, min_range: float
) -> tuple[I32, I32, I32]:
    """solo (k,), visible (k,), lost_to (k, k + 2) from the rays that hit each actor within range.

    A hit nearer than `min_range` could not have been measured and counts in neither.
    """
    k = len(rays)
    solo, lost_to = np.zeros(k, np.int32), np.zeros((k, k + 2), np.int32)
    for row in range(k):
        by = winner[rays[row][distances[row] >= min_range]]
        solo[row] = len(by)
        column = np.where(by == THING, k, np.where(by == TERRAIN, k + 1, by))
        lost_to[row] = np.bincount(column, minlength=k + 2)
    visible = lost_to.diagonal().copy() if k else np.zeros(0, np.int32)
    lost_to[np.arange(k), np.arange(k)] = 0
    return solo, visible, lost_to


@njit(cache=True, nogil=True)
def _face(
    d: F64,
    T_ws: F64,
    T_stamp: F64,
    weight: F64,
    T_wa: F64,
    winner: I32,
    normal: F32,
    cosine: F32,
    start: int,
    stop: int,
) -> None:
    """Turn normals of rings start..stop to the sensor frame at the stamp, facing the sensor."""
    C = len(T_ws)
    n, e = np.empty(3), np.empty(3)
    for ring in range(start, stop):
        for c in range(C):
            r = ring * C + c
            if winner[r] == -1:
                continue
            for i in range(3):
                n[i] = normal[r, i]
            if winner[r] >= 0:
                a, b, w = winner[r], c // BLOCK, weight[c]
                for i in range(3):
                    e[i] = 0.0
                    for j in range(3):
                        e[i] += (T_wa[a, b, i, j] + w * (T_wa[a, b + 1, i, j] - T_wa[a, b, i, j])) * n[j]
                n[:] = e
            for i in range(3):
                e[i] = T_ws[c, 0, i] * n[0] + T_ws[c, 1, i] * n[1] + T_ws[c, 2, i] * n[2]
            size = np.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
            along = (e[0] * d[ring, c, 0] + e[1] * d[ring, c, 1] + e[2] * d[ring, c, 2]) / size
            cosine[r] = min(abs(along), 1.0)
            s = -1.0 / size if along > 0 else 1.0 / size
            for i in range(3):
                normal[r, i] = s * (
                    T_stamp[c, i, 0] * e[0] + T_stamp[c, i, 1] * e[1] + T_stamp[c, i, 2] * e[2]
                )


def describe(pattern: Pattern, motion: SweepMotion, T_world_actor: F64, winner: I32, normal: F32) -> F32:
    """Cosine of incidence (m,); `normal` (m, 3) becomes unit, towards the sensor [sensor at the stamp]."""
    cosine = np.zeros(len(winner), np.float32)
    T_wa = np.ascontiguousarray(T_world_actor)

    def face(start: int) -> None:
        _face(
            pattern.directions,
            motion.T_world_sensor,
            motion.T_stamp_sensor,
            motion.weight,
            T_wa,
            winner,
            normal,
            cosine,
            start,
            start + 8,
        )

    spread(face, range(0, len(pattern.elevation), 8))
    return cosine
