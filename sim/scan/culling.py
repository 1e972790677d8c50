"""Which rays can meet a moving body: a rejection that loses none, ray by ray in its own time."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32, Bool
from sim.scan.bodies import Body
from sim.scan.motion import SweepMotion
from sim.scan.pattern import Pattern
from sim.scene.motion import BLOCK

PAD = 1e-3  # around the box [m]; a ray in single precision strays by 1e-5 m at most
SWAY = 0.01  # around the sphere [m]: what bends within a block of 1.5 ms


@njit(cache=True, nogil=True)
def _view(T_ws: F64, T_wa: F64, center: F64, out: F64) -> None:
    """Point `center` [actor] in the sensor frame, (3,)."""
    for i in range(3):
        out[i] = 0.0
        for k in range(3):
            p = T_wa[k, 3] - T_ws[k, 3]
            for m in range(3):
                p += T_wa[k, m] * center[m]
            out[i] += T_ws[k, i] * p


@njit(cache=True, nogil=True)
def _actor_from_sensor(T_ws: F64, T_wa0: F64, T_wa1: F64, w: float, out: F64) -> None:
    """T_actor_sensor (3, 4) at weight w between two edges of the actor's poses."""
    for i in range(3):
        for j in range(4):
            s = 0.0
            for k in range(3):
                a = T_wa0[k, i] + w * (T_wa1[k, i] - T_wa0[k, i])
                b = T_ws[k, j]
                if j == 3:
                    b -= T_wa0[k, 3] + w * (T_wa1[k, 3] - T_wa0[k, 3])
                s += a * b
            out[i, j] = s


@njit(cache=True, nogil=True)
def _meets(o: F64, d: F64, low: F64, high: F64) -> bool:
    """Whether the ray (origin o, direction d) meets the box, by slabs."""
    near, far = 0.0, np.inf
    for i in range(3):
        if abs(d[i]) < 1e-12:
            if o[i] < low[i] or o[i] > high[i]:
                return False
            continue
        a, b = (low[i] - o[i]) / d[i], (high[i] - o[i]) / d[i]
        near, far = max(near, min(a, b)), min(far, max(a, b))
    return near <= far


@njit(cache=True, nogil=True)
def _window(c0: F64, c1: F64, reach: float, out: F64) -> float:
    """Azimuth, its half width, elevation, its half width of a sphere seen in a block -> nearest distance."""
    x, y, z = (c0[0] + c1[0]) / 2, (c0[1] + c1[1]) / 2, (c0[2] + c1[2]) / 2
    r = reach + np.sqrt((c1[0] - c0[0]) ** 2 + (c1[1] - c0[1]) ** 2 + (c1[2] - c0[2]) ** 2) / 2
    rho, distance = np.hypot(x, y), np.sqrt(x * x + y * y + z * z)
    out[0], out[2] = np.arctan2(y, x), np.arctan2(z, rho)
    out[1] = np.pi if rho <= r else np.arcsin(r / rho)
    out[3] = np.pi if distance <= r else np.arcsin(r / distance)
    return float(distance - r)


@njit(cache=True, nogil=True)
def _in_block(
    first: int, last: int, window: F64, azimuth: F64, elevation: F64, rotor: F64, blind: Bool, chosen: I32
) -> int:
    """Rays (ring * C + column) of columns first..last within the window, into `chosen`; their number."""
    n, C = 0, len(rotor)
    for ring in range(len(elevation)):
        if abs(elevation[ring] - window[2]) > window[3] + 1e-9:
            continue
        for c in range(first, last):
            off = rotor[c] + azimuth[ring] - window[0]
            off -= 2 * np.pi * np.round(off / (2 * np.pi))
            if abs(off) <= window[1] + 1e-9 and not blind[ring, c]:
                chosen[n] = ring * C + c
                n += 1
    return n


@njit(cache=True, nogil=True)
def _to_actor(T: F64, o: F64, d: F64, o_a: F64, d_a: F64) -> None:
    for i in range(3):
        o_a[i] = T[i, 0] * o[0] + T[i, 1] * o[1] + T[i, 2] * o[2] + T[i, 3]
        d_a[i] = T[i, 0] * d[0] + T[i, 1] * d[1] + T[i, 2] * d[2]


@njit(cache=True, nogil=True)
def _gather(
    rays: tuple[F64, F64],
    angles: tuple[F64, F64, F64],
    blind: Bool,
    T_ws: F64,
    T_ws_edge: F64,
    weight: F64,
    T_wa: F64,
    sphere: tuple[F64, float, float],
    box: tuple[F64, F64],
    out: tuple[I32, F32, F32],
) -> int:
    """Fill `out` (ray, origin, direction [actor]) with the rays that meet the box; their number."""
    (origins, directions), (azimuth, elevation, rotor) = rays, angles
    center, reach, max_range = sphere
    C, n = len(rotor), 0
    T, c0, c1, window = np.empty((BLOCK, 3, 4)), np.empty(3), np.empty(3), np.empty(4)
    o_a, d_a, chosen = np.empty(3), np.empty(3), np.empty(BLOCK * len(elevation), np.int32)
    for b in range(len(T_ws_edge) - 1):
        _view(T_ws_edge[b], T_wa[b], center, c0)
        _view(T_ws_edge[b + 1], T_wa[b + 1], center, c1)
        if _window(c0, c1, reach, window) > max_range:
            continue
        first, last = b * BLOCK, min((b + 1) * BLOCK, C)
        count = _in_block(first, last, window, azimuth, elevation, rotor, blind, chosen)
        if count:
            for c in range(first, last):
                _actor_from_sensor(T_ws[c], T_wa[b], T_wa[b + 1], weight[c], T[c - first])
        for k in range(count):
            ring, c = chosen[k] // C, chosen[k] % C
            _to_actor(T[c - first], origins[ring, c], directions[ring, c], o_a, d_a)
            if _meets(o_a, d_a, box[0], box[1]):
                out[0][n] = chosen[k]
                for i in range(3):
                    out[1][n, i], out[2][n, i] = o_a[i], d_a[i]
                n += 1
    return n


def candidates(
    pattern: Pattern, blind: Bool, motion: SweepMotion, T_wa: F64, body: Body, max_range: float
) -> tuple[I32, F32, F32]:
    """The rays that may meet a body that moves, each moved into the actor frame at its own time.

    A block of columns is rejected by the body's bounding sphere, widened by the offset of the
    lasers and the motion within the block, against azimuth and elevation of each laser; what is
    left is tested against the padded box in double precision. No ray that would hit is lost.

    Args:
        blind: (L, C) rays that the ego's own body takes.
        T_wa: (B + 1, 4, 4) T_world_actor at the block edges. max_range: [m].

    Returns:
        ray (n,) as ring * C + column, origins (n, 3) [m, actor], directions (n, 3).
    """
    offset = float(np.sqrt((pattern.origins[:, 0] ** 2).sum(1)).max())
    most = pattern.origins.shape[0] * pattern.columns
    out = (np.empty(most, np.int32), np.empty((most, 3), np.float32), np.empty((most, 3), np.float32))
    n = _gather(
        (pattern.origins, pattern.directions),
        (pattern.azimuth, pattern.elevation, pattern.rotor),
        blind,
        motion.T_world_sensor,
        motion.edge,
        motion.weight,
        np.ascontiguousarray(T_wa),
        (body.center, body.radius + offset + SWAY, max_range),
        (body.low - PAD, body.high + PAD),
        out,
    )
    return out[0][:n], out[1][:n], out[2][:n]
