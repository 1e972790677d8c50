"""Motion models against the printed equations, integrated motion and their own noise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from datmo.tracks.config import TrackerConfig
from datmo.tracks.models import (
    ConstantTurn,
    ConstantTurnAcceleration,
    ConstantVelocity,
    RandomMotion,
    make_models,
)
from datmo.tracks.models.curved import curvature

NAMES = ("cv", "ctrv", "rm", "ctra", "csav", "cca")
ALL = make_models(TrackerConfig(models=NAMES))


def test_models_are_the_printed_ones():
    x = np.array([[1.0, 2.0, 0.3, 5.0, 0.2]])
    T = 0.4
    ctrv = ConstantTurn(1, 1).propagate(x, T)[0]
    want = [
        1 + 5 / 0.2 * (np.sin(0.3 + 0.2 * T) - np.sin(0.3)),
        2 + 5 / 0.2 * (np.cos(0.3) - np.cos(0.3 + 0.2 * T)),
        0.3 + 0.2 * T,
        5,
        0.2,
    ]
    np.testing.assert_allclose(ctrv, want, atol=1e-12)
    x[0, 4] = 1e-12
    cv = ConstantVelocity(1, 1).propagate(x, T)
    np.testing.assert_allclose(ConstantTurn(1, 1).propagate(x, T)[0, :4], cv[0, :4], atol=1e-9)
    assert cv[0, 4] == 0
    assert ConstantVelocity(1, 1, True).propagate(x, T)[0, 4] == 1e-12
    np.testing.assert_array_equal(RandomMotion(1, 1, 1).propagate(x, T), x)


@pytest.mark.parametrize("model", ALL[3:], ids=NAMES[3:])
@pytest.mark.parametrize(
    ("speed", "rate", "accel"), [(9.0, 0.4, 2.0), (9.0, 0.0, -2.0), (5.0, -0.9, 0.0), (-2.0, 0.3, 0.5)]
)
def test_curved_models_solve_their_equations_of_motion(model, speed, rate, accel):
    """By a Runge-Kutta integration of what each keeps constant."""
    bend, size = rate / speed, 6 if model.has_acceleration else 5
    a = accel if model.has_acceleration else 0.0

    def flow(t, s):
        v = speed + a * t
        turn = rate if isinstance(model, ConstantTurnAcceleration) else bend * v
        return [v * np.cos(s[2]), v * np.sin(s[2]), turn, a]

    end = solve_ivp(flow, (0, 0.5), [1.0, 2.0, 0.3, speed], rtol=1e-12, atol=1e-12).y[:, -1]
    moved = model.propagate(np.array([[1.0, 2.0, 0.3, speed, rate, accel]])[:, :size], 0.5)[0]
    np.testing.assert_allclose(moved[:4], end, atol=1e-9)
    last = rate if isinstance(model, ConstantTurnAcceleration) else bend * end[3]
    assert moved[4] == pytest.approx(last, abs=1e-12)
    assert moved[5:].tolist() == [accel][: size - 5]


def test_who_stands_has_no_curvature():
    x = np.array([[0.0, 0, 0.3, 0, 0.4], [0, 0, 0.3, 0.01, 0.4], [0, 0, 0.3, 0.5, 0.4]])
    np.testing.assert_allclose(curvature(x), [0, 0.016, 0.8])


@pytest.mark.parametrize("model", ALL, ids=NAMES)
def test_noise_of_two_steps_is_that_of_one(model):
    """White noise in continuous time: Q(2T) = F Q(T) F' + Q(T), to the order of the step."""
    x, T, h = np.array([[0.0, 0, 0.7, 6.0, 0.0, 0.0]]), 0.05, 1e-6
    F = np.array(
        [(model.propagate(x + h * d, T) - model.propagate(x - h * d, T))[0] / (2 * h) for d in np.eye(6)]
    ).T
    Q = model.noise(x, T)[0]
    np.testing.assert_allclose(F @ Q @ F.T + Q, model.noise(x, 2 * T)[0], atol=2e-8)
    assert np.linalg.eigvalsh(Q).min() > 0
