"""Which rays can meet a moving body: a rejection that loses none, ray by ray in its own time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32, Bool
from sim.scan.bodies import Body
from sim.scan.motion import SweepMotion
from sim.scan.pattern import Pattern
from sim.scene.motion import BLOCK

PAD = 1e-3  # around the box [m]; a ray in single precision strays by 1e-5 m at most
SWAY = 0.01  # around the sphere [m]: what bends within a block of 1.5 ms
SLACK = 1e-9  # around a window [rad]
ALL_ROUND = 2 * np.pi  # of a window that leaves nothing out


@njit(cache=True, nogil=True)
def _view(T_ws: F64, b: int, T_wa: F64, a: int, center: F64, out: F64) -> None:
    """Middle center[a] [actor] of actor a's sphere in the sensor frame at edge b of the blocks, (3,)."""
    for i in range(3):
        out[i] = 0.0
        for k in range(3):
            p = T_wa[a, b, k, 3] - T_ws[b, k, 3]
            for m in range(3):
                p += T_wa[a, b, k, m] * center[a, m]
            out[i] += T_ws[b, k, i] * p


@njit(cache=True, nogil=True)
def _turn(angle: float) -> float:
    """The same angle within half a turn [rad]."""
    return float(angle - 2 * np.pi * np.rint(angle / (2 * np.pi)))


@njit(cache=True, nogil=True)
def _window(
    c0: F64, c1: F64, reach: float, middle: float, half: float, limit: float, out: F64, n: int
) -> bool:
    """Whether a sphere that goes from c0 to c1 during a block may be met by its rays, and where.

    Args:
        middle, half: the azimuths of the block's rays [rad]. limit: as far as they go [m].
        out: row n becomes azimuth, its half width, elevation, its half width [rad].
    """
    x, y, z = (c0[0] + c1[0]) / 2, (c0[1] + c1[1]) / 2, (c0[2] + c1[2]) / 2
    r = reach + np.sqrt((c1[0] - c0[0]) ** 2 + (c1[1] - c0[1]) ** 2 + (c1[2] - c0[2]) ** 2) / 2
    rho = np.sqrt(x * x + y * y)
    distance = np.sqrt(rho * rho + z * z)
    if distance - r > limit:
        return False
    out[n, 0] = np.arctan2(y, x)
    out[n, 1] = ALL_ROUND if rho <= r else np.arcsin(r / rho)
    if abs(_turn(middle - out[n, 0])) > out[n, 1] + half + SLACK:
        return False
    out[n, 2] = np.arctan2(z, rho)
    out[n, 3] = ALL_ROUND if distance <= r else np.arcsin(r / distance)
    return True


@njit(cache=True, nogil=True)
def _windows(
    T_ws_edge: F64,
    T_wa: F64,
    sphere: tuple[F64, F64],
    angles: tuple[F64, F64, F64],
    limit: float,
    where: I32,
    window: F64,
) -> tuple[int, int]:
    """Fill the (actor, block) in which an actor may be seen, and its window; their number, the most rays."""
    (center, reach), (azimuth, elevation, rotor) = sphere, angles
    c0, c1, n, most, C = np.empty(3), np.empty(3), 0, 0, len(rotor)
    low, high = azimuth.min(), azimuth.max()
    for a in range(len(T_wa)):
        _view(T_ws_edge, 0, T_wa, a, center, c1)
        for b in range(len(T_ws_edge) - 1):
            c0[:] = c1
            _view(T_ws_edge, b + 1, T_wa, a, center, c1)
            left, right = rotor[b * BLOCK] + high, rotor[min((b + 1) * BLOCK, C) - 1] + low
            if not _window(c0, c1, reach[a], (left + right) / 2, (left - right) / 2, limit, window, n):
                continue
            rings = 0
            for ring in range(len(elevation)):
                rings += abs(elevation[ring] - window[n, 2]) <= window[n, 3] + SLACK
            if rings:
                where[n, 0], where[n, 1] = a, b
                n, most = n + 1, most + rings * BLOCK
    return n, most


@njit(cache=True, nogil=True)
def _actor_from_sensor(T_ws: F64, c: int, T_wa: F64, a: int, b: int, w: float, out: F64, n: int) -> None:
    """T_actor_sensor of column c into out[n] (3, 4), at weight w between edges b and b + 1 of actor a."""
    for i in range(3):
        for j in range(4):
            s = 0.0
            for k in range(3):
                e = T_ws[c, k, j]
                if j == 3:
                    e -= T_wa[a, b, k, 3] + w * (T_wa[a, b + 1, k, 3] - T_wa[a, b, k, 3])
                s += (T_wa[a, b, k, i] + w * (T_wa[a, b + 1, k, i] - T_wa[a, b, k, i])) * e
            out[n, i, j] = s


@njit(cache=True, nogil=True)
def _to_actor(T: F64, n: int, o: F64, d: F64, ring: int, c: int, ray: F64) -> None:
    """A ray's origin and direction [actor] -> ray (6,)."""
    x, y, z = o[ring, c, 0], o[ring, c, 1], o[ring, c, 2]
    u, v, w = d[ring, c, 0], d[ring, c, 1], d[ring, c, 2]
    for i in range(3):
        ray[i] = T[n, i, 0] * x + T[n, i, 1] * y + T[n, i, 2] * z + T[n, i, 3]
        ray[i + 3] = T[n, i, 0] * u + T[n, i, 1] * v + T[n, i, 2] * w


@njit(cache=True, nogil=True)
def _meets(ray: F64, low: F64, high: F64, a: int) -> bool:
    """Whether a ray (origin, direction) meets box a, by slabs."""
    near, far = 0.0, np.inf
    for i in range(3):
        o, d = ray[i], ray[i + 3]
        if abs(d) < 1e-12:
            if o < low[a, i] or o > high[a, i]:
                return False
            continue
        p, q = (low[a, i] - o) / d, (high[a, i] - o) / d
        near, far = max(near, min(p, q)), min(far, max(p, q))
    return near <= far


@njit(cache=True, nogil=True)
def _gather(
    rays: tuple[F64, F64],
    angles: tuple[F64, F64, F64],
    blind: Bool,
    sensor: tuple[F64, F64],
    T_wa: F64,
    box: tuple[F64, F64],
    seen: tuple[I32, F64],
    out: tuple[I32, F32, F32, I32],
) -> int:
    """Fill `out` (ray, origin, direction [actor]; first row of each actor) with the rays that meet boxes."""
    (o, d), (azimuth, elevation, rotor), (T_ws, weight), (low, high) = rays, angles, sensor, box
    (where, window), (chosen, origin, direction, start), C, n = seen, out, len(rotor), 0
    T, ray, start[:] = np.empty((BLOCK, 3, 4)), np.empty(6), 0
    for s in range(len(where)):
        a, b = where[s, 0], where[s, 1]
        first, last = b * BLOCK, min((b + 1) * BLOCK, C)
        middle, half = (rotor[first] + rotor[last - 1]) / 2, (rotor[first] - rotor[last - 1]) / 2
        made = np.zeros(BLOCK, np.bool_)
        for ring in range(len(elevation)):
            off = _turn(middle + azimuth[ring] - window[s, 0])
            far = abs(elevation[ring] - window[s, 2]) > window[s, 3] + SLACK
            if far or abs(off) > window[s, 1] + half + SLACK:
                continue
            for c in range(first, last):
                if abs(off + rotor[c] - middle) > window[s, 1] + SLACK or blind[ring, c]:
                    continue
                if not made[c - first]:
                    _actor_from_sensor(T_ws, c, T_wa, a, b, weight[c], T, c - first)
                    made[c - first] = True
                _to_actor(T, c - first, o, d, ring, c, ray)
                if _meets(ray, low, high, a):
                    chosen[n] = ring * C + c
                    for i in range(3):
                        origin[n, i], direction[n, i] = ray[i], ray[i + 3]
                    n += 1
        start[a + 1] = n
    for a in range(len(T_wa)):
        start[a + 1] = max(start[a], start[a + 1])
    return n


@dataclass(frozen=True, eq=False)
class Candidates:
    """Rays that may meet k actors, actor by actor; those of actor a are rows start[a] .. start[a + 1].

    Attributes:
        ray: (n,) as ring * C + column.
        origins: (n, 3) [m, actor]. directions: (n, 3) [actor].
        start: (k + 1,).
    """

    ray: I32
    origins: F32
    directions: F32
    start: I32


def candidates(
    pattern: Pattern, blind: Bool, motion: SweepMotion, T_wa: F64, bodies: Sequence[Body], max_range: float
) -> Candidates:
    """The rays that may meet bodies that move, each moved into the actor's frame at its own time.

    A block of columns is rejected by the body's bounding sphere, widened by the offset of the
    lasers and the motion within the block, against azimuth and elevation of each laser; what is
    left is tested against the padded box in double precision. No ray that would hit is lost.

    Args:
        blind: (L, C) rays that the ego's own body takes.
        T_wa: (k, B + 1, 4, 4) T_world_actor at the block edges. max_range: [m].
    """
    k, blocks = len(T_wa), len(motion.edge) - 1
    offset = float(np.sqrt((pattern.origins[:, 0] ** 2).sum(1)).max())
    center = np.array([body.center for body in bodies])
    reach = np.array([body.radius for body in bodies]) + offset + SWAY
    low, high = np.array([body.low for body in bodies]), np.array([body.high for body in bodies])
    where, window = np.empty((k * blocks, 2), np.int32), np.empty((k * blocks, 4))
    T_wa, angles = np.ascontiguousarray(T_wa), (pattern.azimuth, pattern.elevation, pattern.rotor)
    n, most = _windows(motion.edge, T_wa, (center, reach), angles, max_range, where, window)
    ray, start = np.empty(most, np.int32), np.empty(k + 1, np.int32)
    origins, directions = np.empty((most, 3), np.float32), np.empty((most, 3), np.float32)
    n = _gather(
        (pattern.origins, pattern.directions),
        angles,
        blind,
        (motion.T_world_sensor, motion.weight),
        T_wa,
        (low - PAD, high + PAD),
        (where[:n], window[:n]),
        (ray, origins, directions, start),
    )
    return Candidates(ray[:n], origins[:n], directions[:n], start)
