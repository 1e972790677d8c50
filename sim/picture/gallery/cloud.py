"""What an HDL-64E returns of one mesh on a plain floor."""

from __future__ import annotations

from functools import cache

import numpy as np

from datmo.arrays import F32, F64, I32
from sim.scan.embree import Mesh
from sim.scan.pattern import Pattern, pattern
from sim.scan.units import unit

UNIT, RATE, HEIGHT = "hdl64e-s3-20171102", 10.0, 1.73
NEAR, FAR, TALL = 10.0, 30.0, 4.0
"""From the sensor to the nearest side of a mesh, and to that of one taller than the last: the topmost ring
rises by no more than 2.4 degrees [m]."""
NOISE = 0.01  # of the range [m]
AROUND = 1.5  # so much floor is seen beside the mesh [m]


def distance(height: float) -> float:
    """From the sensor to the nearest side of a mesh so tall [m]."""
    return FAR if height > TALL else NEAR


def cloud(vertices: F32, triangles: I32, azimuth_deg: float) -> tuple[F64, I32]:
    """Returns (n, 3) [m, in the mesh's frame] and the triangles (n,) that they are of, -1 the floor.

    Args:
        azimuth_deg: of the sensor as the mesh sees it.
    """
    a = np.deg2rad(azimuth_deg)
    towards = np.array([np.cos(a), np.sin(a)])
    used = vertices[triangles].reshape(-1, 3).astype(float)
    off = distance(float(used[:, 2].max()))
    side = float((used[:, :2] * towards).sum(1).max())
    aside = float(np.abs(used[:, 0] * towards[1] - used[:, 1] * towards[0]).max()) + AROUND
    behind = side - float((used[:, :2] * towards).sum(1).min())
    c, s = -towards  # the sensor looks back along its azimuth
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    stand = np.append((off + side) * towards, HEIGHT)
    rays = hdl64()
    ahead = np.abs(np.arctan2(rays.directions[..., 1], rays.directions[..., 0])) < np.arctan2(aside, off)
    d = np.einsum("ij,nj->ni", turn, rays.directions[ahead])
    o = np.einsum("ij,nj->ni", turn, rays.origins[ahead]) + stand
    hits = Mesh(vertices, triangles).cast(o.astype(np.float32), d.astype(np.float32))
    floor = np.where(d[:, 2] < 0, -o[:, 2] / np.minimum(d[:, 2], -1e-9), np.inf)
    reach = np.where(hits.triangle >= 0, hits.distance.astype(float), np.inf)
    which = np.where(reach < floor, hits.triangle, -1).astype(np.int32)
    reach = np.minimum(reach, floor)
    near = reach < off + behind + 2 * AROUND
    reach = reach + np.random.default_rng(0).normal(0, NOISE, len(reach))
    points = o[near] + reach[near, None] * d[near]
    return points, which[near]


@cache
def hdl64() -> Pattern:
    """The rays of one sweep."""
    return pattern(unit(UNIT), RATE)
