"""Mixed edges: a beam has a width, and where it straddles an edge it meets two surfaces."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32, U8
from datmo.messages import FalseReturn
from sim.scan.caster import Hits
from sim.scan.luck import Luck
from sim.scan.merge import NOTHING
from sim.scan.pattern import Pattern
from sim.scan.pool import spread
from sim.scan.returns import Returns
from sim.scan.surface import Surfaces

PULSE = 0.75
"""Half the length of a 5 ns pulse (HDL-64E manual): echoes nearer to each other come back as one [m]."""
OFF = 0.1
"""A point farther than this from both surfaces lies on neither [m]."""
NEIGHBOURS = ((0, 1), (0, -1), (1, 0), (-1, 0))
EDGE, SHARE = 10, 11
"""Streams of luck."""
RINGS = 4
"""Rings a block."""


@njit(cache=True, nogil=True)
def _mix(
    rings: tuple[int, int],
    columns: int,
    met: tuple[F32, I32, I32],
    reach: tuple[F64, F64],
    chance: tuple[F32, F32],
    code: int,
    out: tuple[F32, U8],
) -> None:
    """Move the returns of rings start..stop that straddle an edge; see `mix_edges`."""
    (true, winner, thing), (odds_across, odds_up) = met, reach
    (edge, share), (distance, false) = chance, out
    last = len(odds_up) - 1
    for ring in range(rings[0], rings[1]):
        for c in range(columns):
            r = ring * columns + c
            if distance[r] == 0.0 or winner[r] == NOTHING:
                continue
            luck = edge[r]
            for side in range(4):
                i, j = ring + NEIGHBOURS[side][0], c + NEIGHBOURS[side][1]
                if i < 0 or i > last or j < 0 or j >= columns:
                    continue
                odds = odds_across[ring] if i == ring else odds_up[min(i, ring)]
                luck -= odds
                if luck >= 0.0:
                    continue
                n = i * columns + j
                other = winner[n] != winner[r] or thing[n] != thing[r]
                gap = true[n] - true[r]
                if winner[n] != NOTHING and other and abs(gap) < PULSE:
                    moved = 0.5 * share[r] * gap
                    distance[r] += np.float32(moved)
                    if abs(moved) > OFF and abs(gap - moved) > OFF:
                        false[r] = code
                break


def mix_edges(
    pattern: Pattern, hits: Hits, met: Surfaces, returns: Returns, divergence: float, luck: Luck
) -> None:
    """Move returns at the edges of objects, in place.

    A beam of full angle `divergence` whose axis lies an angle delta from its neighbour's is cut by an
    edge somewhere between the two with probability (divergence / 2) / delta. Up to half of it then
    falls on the neighbour's surface. Where the two are nearer than the pulse is long, the echoes
    merge and the range lies between, in proportion to the shares; where they are farther apart, the
    stronger echo wins, and the ray keeps its own. What lies off both surfaces is a false return.

    An edge is where the neighbouring ray of the range image (same ring or same column) met another
    object; the folds of one object do not count.

    Args:
        divergence: [rad].
    """
    step = 2 * np.pi / pattern.columns
    odds_across = np.minimum(divergence / 2 / (step * np.cos(pattern.elevation)), 0.5)
    gaps = np.append(np.maximum(-np.diff(pattern.elevation), 1e-6), np.inf)
    odds_up = np.minimum(divergence / 2 / gaps, 0.5)
    m = len(hits.distance)
    chance = luck.uniform(EDGE, m), luck.uniform(SHARE, m)
    seen = hits.distance, hits.winner, met.thing

    def mix(start: int) -> None:
        stop = min(start + RINGS, len(pattern.elevation))
        _mix(
            (start, stop),
            pattern.columns,
            seen,
            (odds_across, odds_up),
            chance,
            int(FalseReturn.MIXED_EDGE),
            (returns.distance, returns.false),
        )

    spread(mix, range(0, len(pattern.elevation), RINGS))
