"""Mixed edges: a beam has a width, and where it straddles an edge it meets two surfaces."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32, I64, U8
from datmo.messages import FalseReturn
from sim.scan.caster import Hits
from sim.scan.luck import Luck
from sim.scan.pattern import Pattern
from sim.scan.pool import spread
from sim.scan.returns import Returns
from sim.scan.surface import Surfaces

PULSE = 0.75
"""Half the length of a 5 ns pulse (HDL-64E manual): echoes nearer to each other come back as one [m]."""
OFF = 0.05
"""A point farther than this from both surfaces lies on neither [m]: five times the noise and more."""
JUMP, BEND = 0.1, 0.5
"""An edge steps this much [m], and this share of the steeper slope, out of the slopes beside it: so much
do rough grounds seen at grazing angles step without an edge."""
SIDES = ((0, 1), (0, -1), (1, 0), (-1, 0))
"""Neighbours in the range image: ring, column."""
EDGE, SHARE = 10, 11
"""Streams of luck."""
RINGS = 4
"""Rings a block."""

Image = tuple[F32, I32]
"""Range [m], infinite for none, of L * C rays; column shift of each of L rings, see `shifts`."""


@njit(cache=True, nogil=True)
def _ray(image: Image, ring: int, c: int, side: int, steps: int) -> int:
    """The ray `steps` beyond ring, column c on a side of the range image, -1 for none."""
    L = len(image[1])
    C = len(image[0]) // L
    i = ring + steps * SIDES[side][0]
    if i < 0 or i >= L:
        return -1
    j = c + steps * SIDES[side][1] + image[1][i] - image[1][ring]
    return i * C + j if 0 <= j < C else -1


@njit(cache=True, nogil=True)
def _step(image: Image, a: int, b: int) -> float:
    """Range at ray b less that at ray a [m], 0 where one of them met nothing."""
    step = 0.0
    if a >= 0 and b >= 0:
        step = float(image[0][b]) - float(image[0][a])
    return step if abs(step) < np.inf else 0.0


@njit(cache=True, nogil=True)
def _edge(image: Image, ring: int, c: int, side: int) -> int:
    """The neighbour on a side if there is an edge before it, -1 if not.

    At an edge the range steps out of what the slopes before and behind it span; on a plane, or at a
    fold where two surfaces touch, it does not.
    """
    r = ring * (len(image[0]) // len(image[1])) + c
    n = _ray(image, ring, c, side, 1)
    if n < 0:
        return -1
    gap = _step(image, r, n)
    before = _step(image, _ray(image, ring, c, side, -1), r)
    behind = _step(image, n, _ray(image, ring, c, side, 2))
    slack = JUMP + BEND * max(abs(before), abs(behind))
    return n if gap > max(before, behind) + slack or gap < min(before, behind) - slack else -1


@njit(cache=True, nogil=True)
def _at_edges(rings: tuple[int, int], image: Image, distance: F32) -> I64:
    """The rays of rings start..stop that have an edge on some side, and a return."""
    C = len(distance) // len(image[1])
    rays, n = np.empty((rings[1] - rings[0]) * C, np.int64), 0
    for ring in range(rings[0], rings[1]):
        for c in range(C):
            r = ring * C + c
            if distance[r] == 0.0:
                continue
            for side in range(4):
                if _edge(image, ring, c, side) >= 0:
                    rays[n] = r
                    n += 1
                    break
    return rays[:n].copy()


@njit(cache=True, nogil=True)
def _blend(gap: float, mine: float, other: float) -> float:
    """How far a return moves towards the other surface [m], by the two powers."""
    weight = other / max(mine + other, 1e-30)
    if abs(gap) < PULSE:
        return gap * weight
    return gap if weight > 0.5 else 0.0


@njit(cache=True, nogil=True)
def _mix(
    rays: I64,
    image: Image,
    power: F32,
    odds: tuple[F64, F64],
    chance: tuple[F32, F32],
    how: tuple[float, int],
    out: tuple[F32, U8, I32],
) -> None:
    """Move the returns of some rays, see `mix_edges`."""
    true, C, (nearest, code) = image[0], len(power) // len(image[1]), how
    for k in range(len(rays)):
        r = rays[k]
        ring, luck = r // C, float(chance[0][k])
        for side in range(4):
            up = min(ring, ring + SIDES[side][0])
            luck -= odds[0][ring] if side < 2 else odds[1][up]
            if luck >= 0.0:
                continue
            n = _edge(image, ring, r - ring * C, side)
            if n < 0 or not nearest <= true[n] < np.inf:
                break
            gap, share = float(true[n]) - float(true[r]), 0.5 * float(chance[1][k])
            moved = _blend(gap, (1 - share) * power[r], share * power[n])
            out[0][r] += moved
            if abs(gap - moved) < abs(moved):
                out[2][r] = n
            if abs(moved) > OFF and abs(gap - moved) > OFF:
                out[1][r] = code
            break


def shifts(pattern: Pattern) -> I32:
    """Columns (L,) by which each ring lags: ring i looks at column c + shifts[i] where a ring without
    correction of its azimuth looks at c."""
    return np.round(pattern.azimuth / (2 * np.pi / pattern.columns)).astype(np.int32)


def mix_edges(
    pattern: Pattern,
    hits: Hits,
    met: Surfaces,
    returns: Returns,
    divergence: float,
    nearest: float,
    luck: Luck,
) -> None:
    """Move returns at edges, in place.

    A beam of full angle `divergence` whose axis lies an angle delta from its neighbour's is cut by an
    edge somewhere between the two with probability (divergence / 2) / delta. A share of up to half of
    it then falls on the neighbour's surface. Where the two are nearer than the pulse is long, the
    echoes merge, and the range is their mean, weighted by power; where they are farther apart, the
    stronger echo is the one reported. What lies off both surfaces is a false return; the others keep
    or change the surface they lie on. Silhouettes against the sky stay as the axis of the beam sees
    them.

    Args:
        divergence: [rad]. nearest: measured range [m].
    """
    step, L = 2 * np.pi / pattern.columns, len(pattern.elevation)
    across = np.minimum(divergence / 2 / (step * np.cos(pattern.elevation)), 0.5)
    up = np.minimum(divergence / 2 / np.maximum(np.abs(np.diff(pattern.elevation)), 1e-6), 0.5)
    image = hits.distance, shifts(pattern)
    power = met.reflectivity * hits.cosine / np.maximum(hits.distance, np.float32(1e-3)) ** 2
    rings = [(a, min(a + RINGS, L)) for a in range(0, L, RINGS)]
    found = spread(lambda some: _at_edges(some, image, returns.distance), rings)
    rays = np.concatenate(found)
    chance = luck.uniform_at(EDGE, rays), luck.uniform_at(SHARE, rays)
    how = nearest, int(FalseReturn.MIXED_EDGE)
    out = returns.distance, returns.false, returns.source
    _mix(rays, image, power, (across, np.append(up, 0.5)), chance, how, out)
