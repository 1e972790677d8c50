"""The sensor's pose at each column of a sweep, and its rays in the world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F32, F64
from datmo.errors import SimulationError
from datmo.geometry import inverse
from sim.scan.pattern import Pattern
from sim.scan.pool import spread
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
    block = column // BLOCK
    first, last = block * BLOCK, np.minimum((block + 1) * BLOCK, C)
    weight = (column + 1 - first) / (last - first)
    T_ws = edge[block] + weight[:, None, None] * (edge[block + 1] - edge[block])
    T_stamp = np.einsum("ij,cjk->cik", inverse(edge[-1]), T_ws)
    return SweepMotion(edge, weight, T_ws, np.ascontiguousarray(T_stamp))


@njit(cache=True, nogil=True)
def _carry(T: F64, o: F64, d: F64, o_w: F32, d_w: F32, start: int, stop: int) -> None:
    """Rays of rings start..stop into the world, in single precision."""
    C = len(T)
    for ring in range(start, stop):
        for c in range(C):
            n = ring * C + c
            for i in range(3):
                x, y, z = o[ring, c, 0], o[ring, c, 1], o[ring, c, 2]
                o_w[n, i] = T[c, i, 0] * x + T[c, i, 1] * y + T[c, i, 2] * z + T[c, i, 3]
                x, y, z = d[ring, c, 0], d[ring, c, 1], d[ring, c, 2]
                d_w[n, i] = T[c, i, 0] * x + T[c, i, 1] * y + T[c, i, 2] * z


def world_rays(pattern: Pattern, motion: SweepMotion) -> tuple[F32, F32]:
    """Origins and directions (L * C, 3) of every ray in the world, ring by ring."""
    rings, C = len(pattern.elevation), pattern.columns
    o_w, d_w = np.empty((rings * C, 3), np.float32), np.empty((rings * C, 3), np.float32)

    def carry(start: int) -> None:
        _carry(motion.T_world_sensor, pattern.origins, pattern.directions, o_w, d_w, start, start + 8)

    spread(carry, range(0, rings, 8))
    return o_w, d_w
