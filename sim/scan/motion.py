"""The sensor's pose at each column of a sweep, and its rays in the world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F32, F64
from datmo.errors import SimulationError
from datmo.geometry import inverse
from sim.scan.pattern import Pattern
from sim.scene.motion import BLOCK, Poses, edges


@dataclass(frozen=True, eq=False)
class SweepMotion:
    """Where the sensor is during one sweep.

    Attributes:
        edge: (B + 1, 4, 4) T_world_sensor at the block edges; the last is at the stamp.
        weight: (C,) how far each column lies between the edges of its block, (0, 1].
        T_world_sensor: (C, 4, 4) at each column, linear between the edges.
        T_stamp_sensor: (C, 4, 4) takes the sensor frame at each column to that at the stamp.
    """

    edge: F64
    weight: F64
    T_world_sensor: F64
    T_stamp_sensor: F64


def sweep_motion(pattern: Pattern, poses: Poses, T_ego_sensor: F64) -> SweepMotion:
    """The sensor's motion on an ego that moves as `poses` say.

    Raises:
        SimulationError: the edges of `poses` are not those of this pattern.
    """
    C = pattern.columns
    want = edges(C, pattern.period)
    if poses.time.shape != want.shape or not np.allclose(poses.time, want, atol=1e-9):
        raise SimulationError(
            f"poses have {len(poses.time)} edges from {poses.time[0]:.4f} s; a sweep of {C} columns needs "
            f"{len(want)} from {want[0]:.4f} s; make them with sim.scene.motion.edges"
        )
    edge = np.ascontiguousarray(np.einsum("eij,jk->eik", poses.T_world_ego, T_ego_sensor))
    column = np.arange(C)
    first = column // BLOCK * BLOCK
    weight = (column + 1 - first) / (np.minimum(first + BLOCK, C) - first)
    T_ws, T_stamp = np.zeros((C, 4, 4)), np.zeros((C, 4, 4))
    _at_columns(edge, weight, inverse(edge[-1]), T_ws, T_stamp)
    return SweepMotion(edge, weight, T_ws, T_stamp)


@njit(cache=True, nogil=True)
def _at_columns(edge: F64, weight: F64, T_stamp_world: F64, T_ws: F64, T_stamp: F64) -> None:
    """Fill T_world_sensor and T_stamp_sensor (C, 4, 4) of each column."""
    for c in range(len(weight)):
        b, w = c // BLOCK, weight[c]
        for i in range(3):
            for j in range(4):
                T_ws[c, i, j] = edge[b, i, j] + w * (edge[b + 1, i, j] - edge[b, i, j])
        T_ws[c, 3, 3] = T_stamp[c, 3, 3] = 1.0
        for i in range(3):
            for j in range(4):
                T_stamp[c, i, j] = T_stamp_world[i, 3] if j == 3 else 0.0
                for k in range(3):
                    T_stamp[c, i, j] += T_stamp_world[i, k] * T_ws[c, k, j]


@njit(cache=True, nogil=True)
def _carry(T: F64, o: F64, d: F64, start: int, o_w: F32, d_w: F32) -> None:
    """The rays from row `start` on into the world, in single precision."""
    C = len(T)
    ring, c = start // C, start % C
    for n in range(len(o_w)):
        x, y, z = o[ring, c, 0], o[ring, c, 1], o[ring, c, 2]
        u, v, w = d[ring, c, 0], d[ring, c, 1], d[ring, c, 2]
        for i in range(3):
            o_w[n, i] = T[c, i, 0] * x + T[c, i, 1] * y + T[c, i, 2] * z + T[c, i, 3]
            d_w[n, i] = T[c, i, 0] * u + T[c, i, 1] * v + T[c, i, 2] * w
        c += 1
        if c == C:
            ring, c = ring + 1, 0


def world_rays(pattern: Pattern, motion: SweepMotion, rays: slice | None = None) -> tuple[F32, F32]:
    """Origins and directions (n, 3) of the rays in the world, ring by ring.

    Args:
        rays: rows ring * C + column of those wanted, all L * C if not given.
    """
    start, stop, _ = (rays or slice(None)).indices(len(pattern.elevation) * pattern.columns)
    o_w, d_w = np.empty((stop - start, 3), np.float32), np.empty((stop - start, 3), np.float32)
    _carry(motion.T_world_sensor, pattern.origins, pattern.directions, start, o_w, d_w)
    return o_w, d_w
