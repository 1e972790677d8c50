"""The coarse sheet: a robust two-dimensional ground, blind to what stands on it.

It ties all segments together and is the expected ground h0 of every method. Weights settle in rounds
(iteratively re-weighted least squares) on a lattice of a third of the grid's lines and bins.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, I64, Bool
from datmo.ground.chebyshev import weights
from datmo.ground.lattice import Lattice, Prior, corners, evaluate, factor, gather, relax

THIRD = 3
QUANTILE = 0.35
FIRST_SCALES = np.geomspace(1.0, 0.1, 6)
ROBUST_SCALES = np.geomspace(4.0, 1.0, 4)
LATER_SCALES = np.array([2.0, 1.0])
# The lines next to a line and those behind pull at it with up to 10/6 of what holds it.
STEPS, LAST_STEPS = weights(5, 0.1, 8 / 3), weights(16, 0.05, 8 / 3)
BELOW = 3.0
MEDIAN_OF_NORMAL, FEWEST = 0.6745, 10
LEAN_FROM, LEAN_QUANTILE = 20.0, 0.9  # [m]

Places = tuple[I64, F64, I64, F64]


def coarse_lattice(segments: int, centers: F64) -> Lattice:
    """The lattice of a third of the lines and radii of a grid with bins' middles `centers` [m]."""
    groups = np.array_split(centers, -(-len(centers) // THIRD))
    return Lattice(-(-segments // THIRD), np.array([group.mean() for group in groups]))


@numba.njit(cache=True, nogil=True)
def _quantile_weight(e: float, scale: float, low: float) -> float:
    return float((low if e > 0 else 1 - low) * scale / np.sqrt(e * e + scale * scale))


@numba.njit(cache=True, nogil=True)
def _robust_weight(e: float, scale: float, below: float) -> float:
    u = e / (below * scale) if e < 0 else e / scale
    fall = 1 + u * u
    return 1 / (fall * fall)


@numba.njit(cache=True, nogil=True)
def _settle(
    f: F64,
    y: F64,
    weight: F64,
    line: I64,
    s: F64,
    node: I64,
    t: F64,
    bands: F64,
    near: F64,
    second: F64,
    quantile: float,
    below: float,
    first: F64,
    later: F64,
    steps: F64,
    last: F64,
) -> None:
    M, N = f.shape
    rows = np.flatnonzero(weight)
    y, weight, line, s, node, t = y[rows], weight[rows], line[rows], s[rows], node[rows], t[rows]
    normal, w = np.empty((5, N, 1 + M)), np.empty(len(y))
    for k in range(len(first) + len(later)):
        expected = evaluate(f, line, s, node, t)
        for i in range(len(y)):
            e = y[i] - expected[i]
            if k < len(first):
                w[i] = weight[i] * _quantile_weight(e, first[k], quantile)
            else:
                w[i] = weight[i] * _robust_weight(e, later[k - len(first)], below)
        gather(w, y, line, s, node, t, normal)
        if k == 0 and len(first) == 0:
            f[:] = np.where(normal[0, :, 1:].T > 0.0, f, 0.0)  # what bore on these nodes is out
        factors = factor(normal, bands)
        relax(f, normal, factors, near, second, last if k == len(first) + len(later) - 1 else steps)


@dataclass(frozen=True)
class Sheet:
    """A fitted sheet: heights f (M', N') over the plane on a lattice [m]."""

    lattice: Lattice
    f: F64

    def at(self, azimuth: F64, radius: F64, segments: int) -> F64:
        """Height (n,) over the plane at azimuths (n,), in segments of the grid, and radii (n,) [m]."""
        parts = corners(azimuth, radius, self.lattice.lines, segments, self.lattice.radii)
        return np.asarray(evaluate(self.f, *parts))


def flat_sheet(lattice: Lattice) -> Sheet:
    """The plane itself."""
    return Sheet(lattice, np.zeros((lattice.lines, len(lattice.radii))))


def settle(
    sheet: Sheet,
    y: F64,
    weight: F64,
    places: Places,
    prior: Prior,
    noise: float,
    asymmetric: bool,
    first: bool,
) -> Sheet:
    """The sheet drawn through the ground among lowest points, starting from `sheet`.

    The `first` time for the quantile 0.35, then robustly with a scale that shrinks to the noise; later
    with that scale only. Below counts more than above, since what is not ground stands above it.

    Args:
        y: (n,) height over the plane [m]. weight: (n,) 1 for an ordinary point, 0 leaves it out.
        places: `corners` of the points. noise: [m].
    """
    f = sheet.f.copy()
    quantile, below = (QUANTILE, BELOW) if asymmetric else (0.5, 1.0)
    scales = (FIRST_SCALES, noise * ROBUST_SCALES) if first else (np.empty(0), noise * LATER_SCALES)
    bands = prior.bands, prior.next, prior.second
    last = STEPS if first else LAST_STEPS
    _settle(f, y, weight, *places, *bands, quantile, below, *scales, STEPS, last)
    return Sheet(sheet.lattice, f)


def learned_bend(sheet: Sheet, seen: Bool, radius: float) -> tuple[float, float]:
    """How the sheet bends where it was seen: robust std of its change of slope from node to node [m/m], and
    how far the ground leans away from its plane from 20 m on, as a slope from the sensor [m/m].

    The first tells how rough the ground is, the second how hilly (the 90 % quantile, since one flank may be
    even). 0 where fewer than ten places tell.

    Args:
        seen: (M, N) cells of the grid with ground. radius: places farther than this do not count [m].
    """
    lattice = sheet.lattice
    M, N = seen.shape
    padded = np.zeros((lattice.lines * THIRD, len(lattice.radii) * THIRD), bool)
    padded[:M, :N] = seen
    near = lattice.radii < radius
    nodes = np.asarray(padded.reshape(lattice.lines, THIRD, -1, THIRD).any((1, 3)))[:, near]
    r, f = lattice.radii[near], sheet.f[:, near]
    slope, known = np.diff(f) / np.diff(r), nodes[:, 2:] & nodes[:, 1:-1] & nodes[:, :-2]
    turn = _quantile(np.abs(np.diff(slope))[known], 0.5) / MEDIAN_OF_NORMAL
    far = r >= LEAN_FROM
    return turn, _quantile((np.abs(f[:, far]) / r[far])[nodes[:, far]], LEAN_QUANTILE)


def _quantile(values: F64, share: float) -> float:
    return float(np.quantile(values, share)) if len(values) >= FEWEST else 0.0
