"""What a segment learns from: its cells, thinned, and its pseudo-inputs (3.7.3)."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, I64, Bool
from datmo.ground.fields import Packed, Supports
from datmo.ground.regression import Cells


@numba.njit(cache=True, nogil=True)
def _thin(at: I64, most: int) -> I64:
    """At most `most` of the indices, evenly over their order, the first and the last among them."""
    if len(at) <= most:
        return at
    if most == 1:
        return at[len(at) // 2 : len(at) // 2 + 1]
    return at[(np.arange(most) * (len(at) - 1)) // (most - 1)]


@numba.njit(cache=True, nogil=True)
def _pack(use: Bool, rows: I64, most: int) -> tuple[I64, I64]:
    chosen, count = np.zeros((len(rows), most), np.int64), np.zeros(len(rows), np.int64)
    for k in range(len(rows)):
        at = _thin(np.flatnonzero(use[rows[k]]), most)
        count[k] = len(at)
        chosen[k, : len(at)] = at
    return chosen, count


def pack(cells: Cells, rows: I64, most: int) -> Packed:
    """The used cells of the segments `rows` (B,), at most `most` of each, evenly over their order."""
    chosen, count = _pack(cells.use, rows, most)
    most = max(int(count.max(initial=0)), 1)
    at = rows[:, None], chosen[:, :most]
    return Packed(cells.r[at], cells.y[at], count, chosen[:, :most])


def fullest(cells: Cells, most: int, least: int = 3) -> I64:
    """At most `most` segments with at least `least` used cells, those with most of them first.

    Of equally full segments the farthest-reaching come first, so that turning changes nothing.
    """
    count = cells.use.sum(1)
    rows = np.lexsort((-(cells.r * cells.use).sum(1), -count))[:most]
    return np.asarray(rows[count[rows] >= least])


@numba.njit(cache=True, nogil=True)
def _supports(r: F64, y: F64, use: Bool, height: float, angle: float, most: int) -> tuple[F64, I64]:
    M, N = r.shape
    out, count, elevation = np.zeros((M, most)), np.zeros(M, np.int64), np.zeros(N)
    for m in range(M):
        at = np.flatnonzero(use[m])
        mean = 0.0
        for b in at:
            elevation[b] = np.arctan2(y[m, b] + height, r[m, b])
            mean += elevation[b] / len(at)
        near = np.array([b for b in at if abs(elevation[b] - mean) <= angle], np.int64)
        chosen = _thin(near, most)
        count[m] = len(chosen)
        for k in range(len(chosen)):
            out[m, k] = r[m, chosen[k]]
    return out, count


def pseudo_inputs(cells: Cells, height: float, angle: float, most: int) -> Supports:
    """Pseudo-inputs of each segment (3.7.3): used cells whose vertical angle is within ζ_h of the
    segment's mean vertical angle.

    The angle is taken against the expected ground, so that a slope changes nothing. Of more than
    `most` those stay that are evenly spread over their order: the cost of learning grows with them.

    Args:
        height: of the ground below the sensor [m], negative. angle: ζ_h [rad].
    """
    return Supports(*_supports(cells.r, cells.y, cells.use, height, angle, most))
