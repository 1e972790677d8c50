"""Multi-path: a shiny flank sends the beam on to the ground, and the echo comes the same way back."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I64, U8, Bool
from datmo.messages import VEHICLES, FalseReturn, Kind
from sim.scan.caster import Hits
from sim.scan.embree import Mesh
from sim.scan.luck import Luck
from sim.scan.motion import SweepMotion
from sim.scan.pattern import Pattern
from sim.scan.returns import Returns
from sim.scan.surface import Surfaces

SHARE = 0.002
"""Rays on a vehicle whose mirrored echo beats the direct one: some five points a sweep in a street, as
many as lie half a metre or more below the ground in real sweeps."""
FAINT = 0.02
"""Intensity of such an echo."""
CLEAR = 0.05
"""The mirrored ray is followed from this far on [m]."""
MIRRORED = 12
"""Stream of luck."""
SHINY = np.isin(np.arange(len(Kind)), VEHICLES)


@njit(cache=True, nogil=True)
def _shiny(kind: U8, hit: Bool, shiny: Bool) -> I64:
    """The rays that came back from a shiny kind."""
    rays, n = np.empty(len(kind), np.int64), 0
    for r in range(len(kind)):
        if shiny[kind[r]] and hit[r]:
            rays[n] = r
            n += 1
    return rays[:n].copy()


def mirror(direction: F64, normal: F64) -> F64:
    """Directions (n, 3) after a mirror of unit normal (n, 3)."""
    return np.asarray(direction - 2 * np.einsum("ij,ij->i", direction, normal)[:, None] * normal)


def _met(pattern: Pattern, motion: SweepMotion, rays: I64, distance: F32) -> tuple[F64, F64]:
    """Where rays (n,) end at their distance (m,), and their directions, (n, 3) [world]."""
    ring, column = np.divmod(rays, pattern.columns)
    T = motion.T_world_sensor[column]
    direction = np.einsum("nij,nj->ni", T[:, :3, :3], pattern.directions[ring, column])
    origin = np.einsum("nij,nj->ni", T[:, :3, :3], pattern.origins[ring, column]) + T[:, :3, 3]
    return origin + distance[rays, None].astype(float) * direction, direction


def add_multipath(
    pattern: Pattern,
    hits: Hits,
    met: Surfaces,
    returns: Returns,
    terrain: Mesh,
    farthest: float,
    luck: Luck,
) -> None:
    """Replace a few returns on vehicles by the echo of the ground that the body mirrors, in place.

    The mirrored ray is cast at the terrain. The sensor knows the path's length only, and puts the
    point on the straight ray: behind the body and, as that ray points down, below the ground.

    Args:
        terrain: in the world. farthest: measured range [m].
    """
    rays = _shiny(met.kind, returns.hit, SHINY)
    rays = rays[luck.uniform_at(MIRRORED, rays) < SHARE]
    if not len(rays):
        return
    place, direction = _met(pattern, hits.motion, rays, hits.distance)
    normal = np.einsum("ij,nj->ni", hits.motion.edge[-1][:3, :3], hits.normal[rays].astype(float))
    onward = mirror(direction, normal)
    start = place + CLEAR * onward
    ground = terrain.cast(start.astype(np.float32), onward.astype(np.float32))
    path = hits.distance[rays] + CLEAR + ground.distance
    good = (ground.triangle >= 0) & (path <= farthest)
    rays = rays[good]
    returns.distance[rays] = path[good]
    returns.intensity[rays] = FAINT
    returns.false[rays] = FalseReturn.MULTIPATH
