"""Mixed edges: a beam has a width, and where it straddles an edge it meets two surfaces."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32, I64, U8, Bool
from datmo.messages import FalseReturn
from sim.scan.caster import Hits
from sim.scan.effects.jumps import beside, jumps, shifts
from sim.scan.luck import Luck
from sim.scan.pattern import Pattern
from sim.scan.returns import Returns
from sim.scan.surface import Surfaces

PULSE = 0.75
"""Half the length of a 5 ns pulse (HDL-64E manual): echoes nearer to each other come back as one [m]."""
OFF = 0.05
"""A point farther than this from both surfaces lies on neither [m]: five times the noise and more."""
CLOSEST = 1e-3  # [m]
SIDES = ((0, 1), (0, -1), (1, 0), (-1, 0))
"""Neighbours in the range image: ring, column."""
EDGE, SHARE = 10, 11
"""Streams of luck."""


@njit(cache=True, nogil=True)
def _neighbour(
    edge: tuple[Bool, Bool], lag: I32, luck: float, odds: tuple[float, float, float], i: int, c: int
) -> tuple[int, int]:
    """Ring and column of the neighbour whose edge cuts the beam of ring i, column c; -1, -1 for none.

    Args:
        odds: that an edge cuts the beam across, towards the next ring, towards the last.
    """
    (across, down), (L, C) = edge, edge[0].shape
    for side in range(4):
        luck -= odds[max(side - 1, 0)]
        if luck >= 0.0:
            continue
        k = i + SIDES[side][0]
        if not 0 <= k < L:
            break
        n = c + SIDES[side][1] + lag[k] - lag[i]
        if not 0 <= n < C:
            break
        cut = across[i, min(c, n)] if k == i else down[i, c] if k > i else down[k, n]
        return (k, n) if cut else (-1, -1)
    return -1, -1


@njit(cache=True, nogil=True)
def _blend(gap: float, mine: float, other: float) -> float:
    """How far a return moves towards the other surface [m], by the two powers."""
    weight = other / max(mine + other, 1e-30)
    if abs(gap) < PULSE:
        return gap * weight
    return gap if weight > 0.5 else 0.0


@njit(cache=True, nogil=True)
def _power(reflectance: float, distance: float) -> float:
    """What comes back [1/m²]."""
    d = np.float32(max(distance, CLOSEST))
    return float(reflectance / (d * d))


@njit(cache=True, nogil=True)
def _mix(
    rays: I64,
    edge: tuple[Bool, Bool],
    lag: I32,
    seen: tuple[F32, F32],
    odds: tuple[F64, F64],
    chance: tuple[F32, F32],
    how: tuple[float, int],
    out: tuple[F32, U8, I32],
) -> None:
    """Move the returns of some rays, see `mix_edges`."""
    (true, reflectance), (nearest, code), C = seen, how, edge[0].shape[1]
    for a in range(len(rays)):
        r = rays[a]
        ring = r // C
        each = odds[0][ring], odds[1][ring], odds[1][ring - 1]
        k, j = _neighbour(edge, lag, chance[0][a], each, ring, r - ring * C)
        n = k * C + j
        if k < 0 or not nearest <= true[n] < np.inf:
            continue
        gap, share = float(true[n]) - float(true[r]), 0.5 * float(chance[1][a])
        mine, other = _power(reflectance[r], true[r]), _power(reflectance[n], true[n])
        moved = _blend(gap, (1 - share) * mine, share * other)
        out[0][r] += moved
        if abs(gap - moved) < abs(moved):
            out[2][r] = n
        if abs(moved) > OFF and abs(gap - moved) > OFF:
            out[1][r] = code


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
    lag = shifts(pattern)
    edge = jumps(hits.distance.reshape(L, -1), lag)
    rays = np.flatnonzero(beside(edge, lag).ravel() & returns.hit)
    chance = luck.uniform_at(EDGE, rays), luck.uniform_at(SHARE, rays)
    odds, how = (across, np.append(up, 0.5)), (nearest, int(FalseReturn.MIXED_EDGE))
    out = returns.distance, returns.false, returns.source
    _mix(rays, edge, lag, (hits.distance, met.reflectance), odds, chance, how, out)
