"""Who won each ray: the nearest hit, the count of rays won and lost, and the surface's normal."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32
from sim.scene.motion import BLOCK

NOTHING, TERRAIN, THING = -1, -2, -3

Found = tuple[F32, I32, I32, F32, F32]
"""Per ray: distance, winner, triangle, normal and cosine, as in `sim.scan.caster.Hits`."""


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
    r: int, along: float, n: tuple[float, float, float], T_sensor_world: F64, normal: F32, cosine: F32
) -> None:
    """Write the normal of what ray r met: unit, facing the sensor; and the cosine of its incidence.

    Args:
        along: n times the ray's direction. n: as Embree gives it [world], of any length.
        T_sensor_world: at the stamp.
    """
    x, y, z = n
    size = np.sqrt(x * x + y * y + z * z)
    cosine[r] = min(abs(along) / size, 1.0)
    s = -1.0 / size if along > 0 else 1.0 / size
    for i in range(3):
        normal[r, i] = s * (T_sensor_world[i, 0] * x + T_sensor_world[i, 1] * y + T_sensor_world[i, 2] * z)


@njit(cache=True, nogil=True)
def describe(start: int, directions: F32, T_sensor_world: F64, found: Found) -> None:
    """Describe what stands still and was met by the rays from `start` on.

    Their normals [world] become those of `Hits`; rays that met nothing get an infinite distance.

    Args:
        directions: (n, 3) [world]. T_sensor_world: at the stamp.
    """
    distance, winner, triangle, normal, cosine = found
    for i in range(len(directions)):
        r = start + i
        if winner[r] >= 0:
            continue
        if winner[r] == NOTHING:
            distance[r], triangle[r], cosine[r] = np.inf, -1, 0.0
            normal[r, 0], normal[r, 1], normal[r, 2] = 0.0, 0.0, 0.0
            continue
        n = float(normal[r, 0]), float(normal[r, 1]), float(normal[r, 2])
        along = directions[i, 0] * n[0] + directions[i, 1] * n[1] + directions[i, 2] * n[2]
        _face(r, along, n, T_sensor_world, normal, cosine)


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
    hit: tuple[F32, I32, F32, F32],
    moving: tuple[F64, F64, F64],
    min_range: float,
    found: Found,
    lost_to: I32,
) -> None:
    """Count who won the rays that hit actors first, first + 1, ..., and describe the rays they won.

    A hit nearer than `min_range` could not have been measured and is not counted.

    Args:
        hit: distance, triangle (-1 none), normal and the ray's direction [actor].
        moving: T_world_actor (k, B + 1, 4, 4) of all actors, the weight of each column (C,), and
            T_sensor_world at the stamp.
        lost_to: (k, k + 2) counts; what an actor won itself stands on the diagonal.
    """
    winner, normal, cosine = found[1], found[3], found[4]
    (distance, triangle, faces, d), (T_wa, weight, T_sensor_world) = hit, moving
    C, k, n = len(weight), len(T_wa), np.empty(3)
    for row in range(first, first + len(start) - 1):
        for m in range(start[row - first], start[row - first + 1]):
            if triangle[m] < 0:
                continue
            r, by = ray[m], winner[ray[m]]
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
            along = d[m, 0] * faces[m, 0] + d[m, 1] * faces[m, 1] + d[m, 2] * faces[m, 2]
            _face(r, along, (n[0], n[1], n[2]), T_sensor_world, normal, cosine)
