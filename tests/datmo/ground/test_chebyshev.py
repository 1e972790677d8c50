from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import chebyshev as cheb

from datmo.ground.chebyshev import weights


@pytest.mark.parametrize("count", [1, 2, 3, 4, 12])
def test_what_is_left_of_an_error_is_the_chebyshev_polynomial(count: int) -> None:
    """Of a part that one plain step takes down by s: T_k of s scaled to -1..1, over that of 0."""
    low, high = 0.2, 2.0
    s = np.linspace(0.0, 2.2, 50)
    error, step = np.ones_like(s), np.zeros_like(s)
    for alpha, beta in weights(count, low, high):
        step = -alpha * s * error + beta * step
        error = error + step
    k = np.eye(count + 1)[count]
    scaled = (high + low - 2 * s) / (high - low)
    want = cheb.chebval(scaled, k) / cheb.chebval((high + low) / (high - low), k)
    np.testing.assert_allclose(error, want, atol=1e-12)
