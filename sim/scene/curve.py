"""Cubic Hermite curves between states that traffic leaves at regular times."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64


def hermite(knots: F64, values: F64, rates: F64, times: F64) -> F64:
    """The C1 cubic through `values` with slopes `rates`, at `times`.

    On an interval of length h, with u = (t - t_i) / h:
    p(t) = (1+2u)(1-u)² p_i + u(1-u)² h m_i + u²(3-2u) p_{i+1} - u²(1-u) h m_{i+1}.

    Args:
        knots: (n,) increasing times [s]. values: (n, ...). rates: (n, ...), per second.
        times: (m,) [s]; outside the knots the curve goes on in a straight line.

    Returns:
        (m, ...)
    """
    t = np.clip(times, knots[0], knots[-1])
    i = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, max(len(knots) - 2, 0))
    j = np.minimum(i + 1, len(knots) - 1)
    extra = (slice(None), *[None] * (values.ndim - 1))
    h = np.where(j > i, knots[j] - knots[i], 1.0)
    u = ((t - knots[i]) / h)[extra]
    h = h[extra]
    v = 1 - u
    inside = (1 + 2 * u) * v**2 * values[i] + u**2 * (3 - 2 * u) * values[j]
    inside = inside + h * (u * v**2 * rates[i] - u**2 * v * rates[j])
    before = np.minimum(times - knots[0], 0)[extra] * rates[0]
    after = np.maximum(times - knots[-1], 0)[extra] * rates[-1]
    return np.asarray(inside + before + after)
