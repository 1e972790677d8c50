"""From rays to returns: where each one lies, the true ground there, and what it met."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32, I64, U8, Bool
from sim.scan.caster import Hits
from sim.scan.merge import TERRAIN
from sim.scan.pattern import Pattern
from sim.scan.pool import blocks, spread
from sim.scan.returns import Returns
from sim.scan.surface import Surfaces


@dataclass(frozen=True, eq=False)
class Gathered:
    """The n returns of a sweep, ring by ring in firing order.

    Attributes:
        place: (n, 3) [m, sensor at the stamp]. own: (n, 3) [m, sensor at the return's own time].
        intensity: (n,). ring: (n,). dt: (n,) [s].
        actor: (n,) row, -1 none. thing: (n,) id, -1 none. kind: (n,). is_ground: (n,).
        normal: (n, 3) [sensor at the stamp]. cause: (n,) `FalseReturn`.
    """

    place: F64
    own: F32
    intensity: F32
    ring: U8
    dt: F32
    actor: I32
    thing: I32
    kind: U8
    is_ground: Bool
    normal: F32
    cause: U8


@njit(cache=True, nogil=True)
def _locate(
    rays: I64, distance: F32, o: F64, d: F64, T: F64, time: F64, out: tuple[F64, F32, U8, F32]
) -> None:
    """Points at `distance` along each ray, in its own frame and taken by its column's T (C, 4, 4)."""
    C, p = len(T), np.empty(3)
    place, own, ring_of, dt = out
    for n in range(len(rays)):
        ring = rays[n] // C
        c = rays[n] - ring * C
        r = distance[rays[n]]
        for i in range(3):
            p[i] = o[ring, c, i] + r * d[ring, c, i]
            own[n, i] = p[i]
        for i in range(3):
            place[n, i] = T[c, i, 0] * p[0] + T[c, i, 1] * p[1] + T[c, i, 2] * p[2] + T[c, i, 3]
        ring_of[n], dt[n] = ring, time[c]


@njit(cache=True, nogil=True)
def _label(
    rays: I64,
    hits: tuple[I32, F32],
    met: tuple[U8, I32],
    returns: tuple[F32, U8],
    false_kind: int,
    out: tuple[F32, I32, I32, U8, Bool, F32, U8],
) -> None:
    """What each return lies on; a false one lies on nothing."""
    intensity, actor, thing, kind, is_ground, normal, cause = out
    for n in range(len(rays)):
        r = rays[n]
        intensity[n], cause[n] = returns[0][r], returns[1][r]
        for i in range(3):
            normal[n, i] = hits[1][r, i]
        if returns[1][r]:
            actor[n], thing[n], kind[n], is_ground[n] = -1, -1, false_kind, False
            continue
        actor[n], thing[n], kind[n] = max(hits[0][r], -1), met[1][r], met[0][r]
        is_ground[n] = hits[0][r] == TERRAIN


def gather(
    pattern: Pattern, T_stamp_sensor: F64, hits: Hits, met: Surfaces, returns: Returns, false_kind: int
) -> Gathered:
    """The returns of a sweep.

    Args:
        T_stamp_sensor: (C, 4, 4) takes the sensor frame at each column to that at the stamp.
        false_kind: `Kind` of returns that lie on no surface.
    """
    rays = np.flatnonzero(returns.hit)
    n = len(rays)
    out = Gathered(
        place=np.empty((n, 3)),
        own=np.empty((n, 3), np.float32),
        intensity=np.empty(n, np.float32),
        ring=np.empty(n, np.uint8),
        dt=np.empty(n, np.float32),
        actor=np.empty(n, np.int32),
        thing=np.empty(n, np.int32),
        kind=np.empty(n, np.uint8),
        is_ground=np.empty(n, np.bool_),
        normal=np.empty((n, 3), np.float32),
        cause=np.empty(n, np.uint8),
    )

    def fill(s: slice) -> None:
        places = out.place[s], out.own[s], out.ring[s], out.dt[s]
        _locate(
            rays[s],
            returns.distance,
            pattern.origins,
            pattern.directions,
            T_stamp_sensor,
            pattern.time,
            places,
        )
        flags = out.actor[s], out.thing[s], out.kind[s], out.is_ground[s]
        labels = out.intensity[s], *flags, out.normal[s], out.cause[s]
        _label(
            rays[s],
            (hits.winner, hits.normal),
            (met.kind, met.thing),
            (returns.intensity, returns.false),
            false_kind,
            labels,
        )

    spread(fill, blocks(n))
    return out
