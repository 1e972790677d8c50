"""Multi-path: a shiny flank sends the beam on to the ground, and the echo comes the same way back."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from datmo.messages import VEHICLES, FalseReturn
from sim.scan.caster import Hits
from sim.scan.embree import Mesh
from sim.scan.luck import Luck
from sim.scan.motion import world_rays
from sim.scan.pattern import Pattern
from sim.scan.returns import Returns
from sim.scan.surface import Surfaces

SHARE = 0.002
"""Rays on a vehicle whose mirrored echo beats the direct one: some five points a sweep in a street, as
many as lie half a metre or more below the ground in real sweeps."""
FAINT = 0.02
"""Intensity of such an echo."""
CLEAR = 0.05
"""The mirrored ray starts this far off the surface [m]."""
MIRRORED = 12
"""Stream of luck."""


def mirror(direction: F64, normal: F64) -> F64:
    """Directions (n, 3) after a mirror of unit normal (n, 3)."""
    return np.asarray(direction - 2 * np.einsum("ij,ij->i", direction, normal)[:, None] * normal)


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
    lucky = luck.uniform(MIRRORED, len(hits.distance)) < SHARE
    rays = np.flatnonzero(lucky & returns.hit & (hits.winner >= 0) & np.isin(met.kind, VEHICLES))
    if not len(rays):
        return
    origin, direction = (part[rays].astype(float) for part in world_rays(pattern, hits.motion))
    T_world_stamp = hits.motion.edge[-1][:3, :3]
    normal = np.einsum("ij,nj->ni", T_world_stamp, hits.normal[rays].astype(float))
    onward = mirror(direction, normal)
    start = origin + hits.distance[rays, None] * direction + CLEAR * normal
    ground = terrain.cast(start.astype(np.float32), onward.astype(np.float32))
    path = hits.distance[rays] + ground.distance
    good = (ground.triangle >= 0) & (path <= farthest)
    rays = rays[good]
    returns.distance[rays] = path[good]
    returns.intensity[rays] = FAINT
    returns.false[rays] = FalseReturn.MULTIPATH
