from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from sim.scene.curve import hermite

numbers = st.floats(-50, 50)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(numbers, numbers), min_size=2, max_size=6), st.integers(0, 2**32 - 1))
def test_it_is_the_hermite_spline(rows: list[tuple[float, float]], seed: int) -> None:
    knots = np.cumsum(np.random.default_rng(seed).uniform(0.02, 0.3, len(rows)))
    values, rates = np.array(rows).T
    times = np.linspace(knots[0], knots[-1], 23)
    np.testing.assert_allclose(
        hermite(knots, values, rates, times), CubicHermiteSpline(knots, values, rates)(times), atol=1e-9
    )


def test_a_cubic_is_reproduced_in_every_column() -> None:
    t = np.array([0.0, 0.1, 0.35])
    cubic = np.polynomial.Polynomial([1.0, -2.0, 3.0, 4.0])
    values = np.stack([cubic(t), -cubic(t)], -1)[:, None, :]
    rates = np.stack([cubic.deriv()(t), -cubic.deriv()(t)], -1)[:, None, :]
    fine = np.linspace(0, 0.35, 40)
    np.testing.assert_allclose(hermite(t, values, rates, fine)[:, 0, 1], -cubic(fine), atol=1e-12)


def test_outside_it_goes_straight_on_and_one_knot_is_enough() -> None:
    found = hermite(np.array([1.0]), np.array([5.0]), np.array([2.0]), np.array([0.0, 1.0, 3.0]))
    np.testing.assert_allclose(found, [3.0, 5.0, 9.0])
