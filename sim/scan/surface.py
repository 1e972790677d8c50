"""What the rays met, beyond geometry: kind, thing, reflectivity and the mean intensity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F32, I32, I64, U8
from datmo.messages import VEHICLES, Kind
from datmo.threads import blocks, spread
from sim.scan.bodies import Body
from sim.scan.caster import Hits
from sim.scan.merge import NOTHING, TERRAIN, THING
from sim.scan.things import Things

REFLECTIVITY = {Kind.ROAD: 0.1, Kind.SIDEWALK: 0.2, Kind.FIELD: 0.3}
"""Of the ground, diffuse, at 905 nm: asphalt, paving, grass and soil."""
LEVEL = {
    Kind.ROAD: 0.235,
    Kind.SIDEWALK: 0.36,
    Kind.FIELD: 0.45,
    Kind.VEGETATION: 0.36,
    Kind.TRUNK: 0.3,
    Kind.BUILDING: 0.24,
    Kind.WALL: 0.24,
    Kind.POLE: 0.3,
    Kind.SIGN: 0.48,
    Kind.THING: 0.25,
}
"""Mean intensity head-on where it is not 0. With the zeros, and at the angles at which streets are seen,
these give the class means of real HDL-64 sweeps."""
GLOSS = {Kind.PEDESTRIAN: 0.7, Kind.BICYCLE: 0.7, Kind.MOTORCYCLE: 0.7}
"""Intensity head-on of what has no such level, as a share of its reflectivity: of cloth; 1 of all else."""
ROUGH = 0.66
"""B / A of Oren and Nayar, "Generalization of Lambert's reflectance model" (SIGGRAPH 1994), for facets
that spread by 1 rad. Seen from where it is lit, such a surface keeps cos t + (B / A) sin² t of its
brightness at incidence t: 0.78 at 83 degrees, as roads do in real sweeps."""
SMOOTH = (*VEHICLES, Kind.UNKNOWN)
"""Paint under a clear coat keeps cos t (1 - (1 - cos t)^5)²: diffuse, less what the coat mirrors away on the
way in and out by Schlick's form of Fresnel's law ("An inexpensive BRDF model for physically-based
rendering", Eurographics 1994). Bonnets at grazing angles are dark, as in real sweeps."""


@dataclass(frozen=True, eq=False)
class Surfaces:
    """What the rays met, (m,) each.

    Attributes:
        kind: of surface. thing: id, -1 none.
        reflectance: what comes back of a beam at its incidence, as a share of what a white diffuse
            surface sends back head-on. level: mean intensity at its incidence.
    """

    kind: U8
    thing: I32
    reflectance: F32
    level: F32


def _table(values: dict[Kind, float], default: float = 0.0) -> F32:
    table = np.full(len(Kind), default, np.float32)
    for kind, value in values.items():
        table[kind] = value
    return table


RHO, MEAN, SHINE = _table(REFLECTIVITY), _table(LEVEL), _table(GLOSS, 1.0)
FLAT = _table(dict.fromkeys(SMOOTH, 0.0), ROUGH)


@njit(cache=True, nogil=True)
def _kept(c: float, flat: float) -> float:
    """Share of its brightness head-on that a surface keeps at an incidence of cosine c."""
    if flat > 0.0:
        return float(c + flat * (1 - c * c))
    passed = 1 - (1 - c) ** 5
    return float(c * passed * passed)


@njit(cache=True, nogil=True)
def _look_up(
    rays: tuple[int, int],
    hits: tuple[I32, I32, F32],
    terrain_kind: U8,
    tables: tuple[F32, F32, F32, F32],
    things: tuple[I32, U8, F32],
    actors: tuple[U8, I64, F32],
    out: tuple[U8, I32, F32, F32],
) -> None:
    """Fill kind, thing, reflectance and level of rays start..stop; see `surfaces`."""
    (winner, triangle, cosine), (rho, mean, shine, flat) = hits, tables
    for r in range(rays[0], rays[1]):
        w, t = winner[r], triangle[r]
        kind, thing, reflectivity = np.uint8(0), np.int32(-1), np.float32(0)
        if w == TERRAIN:
            kind = terrain_kind[t // 2]
            reflectivity = rho[kind]
        elif w == THING:
            kind, thing, reflectivity = things[1][t], things[0][t], things[2][t]
        elif w != NOTHING:
            kind = actors[0][w]
            reflectivity = actors[2][actors[1][w] + t]
        kept = _kept(cosine[r], flat[kind])
        level = mean[kind] if mean[kind] > 0 else shine[kind] * reflectivity
        out[0][r], out[1][r], out[2][r], out[3][r] = kind, thing, reflectivity * kept, level * kept


def surfaces(
    hits: Hits, terrain_kind: U8, things: Things | None, bodies: Sequence[Body], kinds: U8
) -> Surfaces:
    """Look up what each ray met.

    Args:
        terrain_kind: (cells,) kind of each cell of the terrain; triangles 2 c and 2 c + 1 are cell c.
        bodies: of the k actors, and their kinds (k,).
    """
    m = len(hits.winner)
    out = np.empty(m, np.uint8), np.empty(m, np.int32), np.empty(m, np.float32), np.empty(m, np.float32)
    none = np.zeros(0, np.int32), np.zeros(0, np.uint8), np.zeros(0, np.float32)
    listed = none if things is None else (things.thing, things.kind, things.reflectivity)
    each = [body.reflectivity for body in bodies]
    first = np.cumsum([0, *(len(rho) for rho in each)]).astype(np.int64)
    actors = np.ascontiguousarray(kinds, np.uint8), first, np.concatenate([none[2], *each])

    def look_up(rays: slice) -> None:
        _look_up(
            (rays.start, rays.stop),
            (hits.winner, hits.triangle, hits.cosine),
            terrain_kind,
            (RHO, MEAN, SHINE, FLAT),
            listed,
            actors,
            out,
        )

    spread(look_up, blocks(m))
    return Surfaces(*out)
