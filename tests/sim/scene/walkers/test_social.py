from __future__ import annotations

import numpy as np
import pytest

from sim.scene.walkers import social
from sim.scene.walkers.social import TAU, avoid, relax, shun, together


def slow_avoid(x: np.ndarray, v: np.ndarray, i: int) -> np.ndarray:
    """The paper's equations, one pair at a time, with the angle by hand."""
    total = np.zeros(2)
    for j in range(len(x)):
        if j == i:
            continue
        d = np.linalg.norm(x[j] - x[i])
        e = (x[j] - x[i]) / d
        D = 2.0 * (v[i] - v[j]) + e
        t = D / np.linalg.norm(D)
        B = 0.35 * np.linalg.norm(D)
        theta = np.arctan2(t[0] * e[1] - t[1] * e[0], t @ e) + B * 0.005
        K = (-1 if theta < 0 else 1) * min(np.linalg.norm(v[i] - v[j]) / 0.3, 1)
        n = np.array([-t[1], t[0]])
        total -= 4.5 * np.exp(-d / B) * np.exp(-((3 * B * theta) ** 2)) * t
        total -= 4.5 * np.exp(-d / B) * K * np.exp(-((2 * B * theta) ** 2)) * n
    return total


def test_the_velocity_relaxes_exponentially_with_the_published_time() -> None:
    assert TAU == 0.54
    wish, v = np.array([[1.3, 0.0]]), np.zeros((1, 2))
    for step in range(1, 41):
        v = relax(v, wish, np.zeros((1, 2)), 0.05)
        assert v[0, 0] == pytest.approx(1.3 * (1 - np.exp(-0.05 * step / 0.54)), abs=1e-12)


def test_a_constant_force_adds_its_product_with_the_time() -> None:
    v = relax(np.zeros((1, 2)), np.array([[1.0, 0.0]]), np.array([[0.0, 2.0]]), 100.0)
    np.testing.assert_allclose(v, [[1.0, 2.0 * TAU]])


def test_avoidance_is_that_of_the_paper() -> None:
    rng = np.random.default_rng(0)
    x, v = rng.uniform(-4, 4, (7, 2)), rng.normal(0, 1, (7, 2))
    np.testing.assert_allclose(avoid(x, v), [slow_avoid(x, v, i) for i in range(7)], atol=1e-12)
    assert (avoid(x[:1], v[:1]) == 0).all()


def test_those_who_meet_head_on_both_turn_right_and_brake() -> None:
    x, v = np.array([[0.0, 0.0], [4.0, 0.0]]), np.array([[1.4, 0.0], [-1.4, 0.0]])
    force = avoid(x, v)
    assert force[0, 0] < 0
    assert force[0, 1] < -0.2
    np.testing.assert_allclose(force[1], -force[0], atol=1e-12)


def test_a_border_repels_as_published() -> None:
    force = shun(np.array([[[0.0, 0.4]], [[0.3, 0.0]]]))
    np.testing.assert_allclose(force, [[0, 50 * np.exp(-2)], [50 * np.exp(-1.5), 0]])


def test_a_group_draws_in_its_stragglers_and_holds_back_who_is_ahead() -> None:
    x = np.array([[0.0, 0.0], [0.0, 0.9], [6.0, 0.5]])
    v = np.tile([1.3, 0.0], (3, 1))
    force = together(x, v, np.array([0, 0, 0]))
    centre = x.mean(0)
    assert ((centre - x) * force).sum(1).min() > 0
    assert force[2, 0] < -social.BETA[1] * 0.9
    assert (together(x, v, np.array([0, 1, 2])) == 0).all()


def test_partners_abreast_feel_nothing_but_their_distance() -> None:
    x, v = np.array([[0.0, 0.0], [0.0, 0.9]]), np.tile([1.3, 0.0], (2, 1))
    np.testing.assert_allclose(together(x, v, np.array([3, 3])), 0, atol=1e-12)
    assert together(x * 0.5, v, np.array([3, 3]))[0, 1] < 0


def test_two_who_stand_side_by_side_are_at_peace() -> None:
    x, v = np.array([[0.0, 0.0], [0.0, 0.75]]), np.zeros((2, 2))
    for _ in range(400):
        force = avoid(x, v) + together(x, v, np.zeros(2, np.int64))
        v = relax(v, np.zeros((2, 2)), force, 0.05)
        x = x + 0.05 * v
    assert np.abs(v).max() < 1e-4
    assert 0.9 < x[1, 1] - x[0, 1] < 1.3
    np.testing.assert_allclose(x[:, 0], 0, atol=0.1)
