"""From rays to returns: where each one lies, the true ground there, and what it met."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32, I64, U8, Bool
from datmo.messages import Kind, LostRays
from datmo.threads import blocks, spread
from sim.scan.caster import Hits
from sim.scan.merge import TERRAIN
from sim.scan.pattern import Pattern
from sim.scan.returns import Returns
from sim.scan.surface import Surfaces
from sim.scene.terrain import Terrain


@dataclass(frozen=True, eq=False)
class Gathered:
    """The n returns of a sweep, ring by ring in firing order, and the rays that gave none.

    Attributes:
        points: (n, 3) [m, sensor at the stamp if deskewed, else at the return's own time].
        intensity: (n,). ring: (n,). dt: (n,) [s].
        height: (n,) z of the true ground along the sensor's z axis at the point [m, sensor at the stamp].
        actor: (n,) row, -1 none. thing: (n,) id, -1 none. kind: (n,). is_ground: (n,).
        normal: (n, 3) [sensor at the stamp]. cause: (n,) `FalseReturn`.
        lost: sky, lost, dropped, too near; those on the ego's own body have met nothing.
    """

    points: F32
    intensity: F32
    ring: U8
    dt: F32
    height: F32
    actor: I32
    thing: I32
    kind: U8
    is_ground: Bool
    normal: F32
    cause: U8
    lost: LostRays


@njit(cache=True, nogil=True)
def _locate(
    rays: I64,
    distance: F32,
    view: tuple[F64, F64, F64, F64],
    deskewed: bool,
    out: tuple[F64, F32, U8, F32],
) -> None:
    """Points at `distance` along each ray, in its own frame or taken by its column's T (C, 4, 4)."""
    (o, d, time, T), (place, points, ring_of, dt) = view, out
    C = len(T)
    for n in range(len(rays)):
        ring = rays[n] // C
        c = rays[n] - ring * C
        r = distance[rays[n]]
        x = o[ring, c, 0] + r * d[ring, c, 0]
        y = o[ring, c, 1] + r * d[ring, c, 1]
        z = o[ring, c, 2] + r * d[ring, c, 2]
        for i in range(3):
            place[n, i] = T[c, i, 0] * x + T[c, i, 1] * y + T[c, i, 2] * z + T[c, i, 3]
        if deskewed:
            points[n, 0], points[n, 1], points[n, 2] = place[n, 0], place[n, 1], place[n, 2]
        else:
            points[n, 0], points[n, 1], points[n, 2] = x, y, z
        ring_of[n], dt[n] = ring, time[c]


@njit(cache=True, nogil=True)
def _label(
    rays: I64,
    hits: tuple[I32, F32],
    met: tuple[U8, I32],
    returns: tuple[F32, U8, I32],
    false_kind: int,
    out: tuple[F32, I32, I32, U8, Bool, F32, U8],
) -> None:
    """What each return lies on; a false one lies on nothing."""
    intensity, actor, thing, kind, is_ground, normal, cause = out
    (winner, facing), (kind_of, thing_of), (level, false, source) = hits, met, returns
    for n in range(len(rays)):
        r = rays[n]
        intensity[n], cause[n] = level[r], false[r]
        if false[r]:
            actor[n], thing[n], kind[n], is_ground[n] = -1, -1, false_kind, False
            normal[n, 0], normal[n, 1], normal[n, 2] = 0.0, 0.0, 0.0
            continue
        r = source[r]
        actor[n], thing[n], kind[n] = max(winner[r], -1), thing_of[r], kind_of[r]
        is_ground[n] = winner[r] == TERRAIN
        normal[n, 0], normal[n, 1], normal[n, 2] = facing[r, 0], facing[r, 1], facing[r, 2]


@njit(cache=True, nogil=True)
def _lose(
    rays: I64,
    columns: int,
    hits: tuple[I32, F32],
    met: tuple[U8, I32],
    out: tuple[U8, I32, I32, I32, U8, F32],
) -> None:
    """Which ray it is that gave nothing, and what it met."""
    ring, column, actor, thing, kind, far = out
    (winner, distance), (kind_of, thing_of) = hits, met
    for n in range(len(rays)):
        r = rays[n]
        ring[n] = r // columns
        column[n] = r - ring[n] * columns
        actor[n], thing[n], kind[n] = max(winner[r], -1), thing_of[r], kind_of[r]
        far[n] = distance[r] if np.isfinite(distance[r]) else np.nan


def gather(
    pattern: Pattern, hits: Hits, met: Surfaces, returns: Returns, terrain: Terrain, deskewed: bool
) -> Gathered:
    """The returns of a sweep, and the rays without one."""
    rays, gone = np.flatnonzero(returns.hit), np.flatnonzero(~returns.hit)
    out, T_ws = _room(len(rays), len(gone)), hits.motion.edge[-1]
    view = pattern.origins, pattern.directions, pattern.time, hits.motion.T_stamp_sensor
    known = met.kind, met.thing

    def keep(s: slice) -> None:
        place = np.empty((s.stop - s.start, 3))
        where = place, out.points[s], out.ring[s], out.dt[s]
        _locate(rays[s], returns.distance, view, deskewed, where)
        terrain.below(place, T_ws, out.height[s])
        flags = out.actor[s], out.thing[s], out.kind[s], out.is_ground[s]
        labels = out.intensity[s], *flags, out.normal[s], out.cause[s]
        measured = returns.intensity, returns.false, returns.source
        _label(rays[s], (hits.winner, hits.normal), known, measured, int(Kind.FALSE_RETURN), labels)

    def lose(s: slice) -> None:
        lost = out.lost
        columns = lost.ring[s], lost.column[s], lost.actor[s], lost.thing[s], lost.kind[s], lost.range[s]
        _lose(gone[s], pattern.columns, (hits.winner, hits.distance), known, columns)

    jobs = [partial(keep, s) for s in blocks(len(rays))] + [partial(lose, s) for s in blocks(len(gone), 4)]
    spread(lambda job: job(), jobs)
    return out


def _room(n: int, m: int) -> Gathered:
    """Room for n returns and m rays without one."""
    return Gathered(
        points=np.empty((n, 3), np.float32),
        intensity=np.empty(n, np.float32),
        ring=np.empty(n, np.uint8),
        dt=np.empty(n, np.float32),
        height=np.empty(n, np.float32),
        actor=np.empty(n, np.int32),
        thing=np.empty(n, np.int32),
        kind=np.empty(n, np.uint8),
        is_ground=np.empty(n, np.bool_),
        normal=np.empty((n, 3), np.float32),
        cause=np.empty(n, np.uint8),
        lost=LostRays(
            ring=np.empty(m, np.uint8),
            column=np.empty(m, np.int32),
            actor=np.empty(m, np.int32),
            thing=np.empty(m, np.int32),
            kind=np.empty(m, np.uint8),
            range=np.empty(m, np.float32),
        ),
    )
