"""Chebyshev semi-iteration: how far to go with each of a few steps, fixed beforehand.

A step solves a part of a system with the rest held, everywhere at once, so that no order of the parts
decides: f <- f + α (solved - f) + β (the last step). Golub and Varga, Numerische Mathematik 3 (1961).
"""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64


def weights(count: int, low: float, high: float) -> F64:
    """α and β of each step (count, 2), best for parts of the error that one plain step takes down by a share
    between `low` and `high`."""
    middle, half = (high + low) / 2, (high - low) / 2
    sigma = middle / half
    out, rho = [(1 / middle, 0.0)], 1 / sigma
    for _ in range(count - 1):
        before, rho = rho, 1 / (2 * sigma - rho)
        out.append((2 * rho / half, rho * before))
    return np.array(out)
