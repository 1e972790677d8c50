"""Limited-memory BFGS within bounds, without BLAS.

scipy's L-BFGS-B calls threaded BLAS: its bytes and its time then depend on the threads, and in two
threads its own work costs more than the objective. The two-loop recursion is Nocedal & Wright,
Numerical Optimization (2nd ed.), Algorithm 7.4; steps are projected on the box, and variables held
at a bound that the gradient pushes against rest.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from datmo.arrays import F64

MEMORY = 8
ARMIJO = 1e-4
HALVINGS = 6
Function = Callable[[F64], tuple[float, F64]]


def _dot(a: F64, b: F64) -> float:
    return float((a * b).sum())


def _direction(g: F64, pairs: list[tuple[F64, F64]], first: float) -> F64:
    """-H g, H the inverse Hessian by the last steps and changes of the gradient; `first` without any."""
    q, alphas = -g, []
    for s, y in reversed(pairs):
        alpha = _dot(s, q) / _dot(s, y)
        q = q - alpha * y
        alphas.append(alpha)
    q = q * (_dot(*pairs[-1]) / _dot(pairs[-1][1], pairs[-1][1]) if pairs else first)
    for (s, y), alpha in zip(pairs, reversed(alphas), strict=True):
        q = q + (alpha - _dot(y, q) / _dot(s, y)) * s
    return q


def minimise(
    function: Function, x: F64, low: F64, high: F64, steps: int, first: float, tolerance: float = 1e-6
) -> tuple[F64, float, int]:
    """Where at most `steps` lead downhill from x, the value there, and how often it was taken.

    Args:
        function: value and gradient. low, high: bounds. first: inverse curvature before any is
            known. tolerance: relative gain of a step below which to stop.
    """
    x = np.clip(x, low, high)
    value, g = function(x)
    pairs: list[tuple[F64, F64]] = []
    taken = 1
    for _ in range(steps):
        rests = ((x <= low) & (g > 0)) | ((x >= high) & (g < 0))
        free = np.where(rests, 0.0, g)
        d = np.where(rests, 0.0, _direction(free, pairs, first))
        if _dot(d, free) >= 0:  # no descent: forget the curvature
            pairs, d = [], -first * free
        length, before = 1.0, value
        for _ in range(HALVINGS):
            there = np.clip(x + length * d, low, high)
            value_there, g_there = function(there)
            taken += 1
            if value_there <= value + ARMIJO * _dot(free, there - x):
                break
            length /= 4
        else:
            break
        s, y = there - x, g_there - g
        if _dot(s, y) > 1e-10 * _dot(y, y):
            pairs = [*pairs, (s, y)][-MEMORY:]
        x, value, g = there, value_there, g_there
        if before - value <= tolerance * max(abs(value), 1.0):
            break
    return x, value, taken
