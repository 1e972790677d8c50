"""The membrane against dense Gaussian-Markov algebra."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.ground.chebyshev import weights
from datmo.ground.membrane import links, settle

M, R = 12, np.array([2.2, 2.9, 3.7, 4.7, 5.8, 7.0, 9.2, 10.7, 12.5])
N = len(R)


def pairs() -> list[tuple[tuple[int, int], tuple[int, int], float]]:
    """Neighbouring nodes and their distance along range or arc [m]."""
    found = []
    for m in range(M):
        for b in range(N):
            found.append(((m, b), ((m + 1) % M, b), 2 * np.pi / M * R[b]))
            if b + 1 < N:
                found.append(((m, b), (m, b + 1), R[b + 1] - R[b]))
    return found


def precision(c: np.ndarray) -> np.ndarray:
    """(M N, M N): neighbours pull with 1 / (c d), c the mean of both."""
    Q = np.zeros((M * N, M * N))
    for a, b, d in pairs():
        i, j = a[0] * N + a[1], b[0] * N + b[1]
        pull = 1 / ((c[a] + c[b]) / 2 * d)
        Q[[i, j], [i, j]] += pull
        Q[[i, j], [j, i]] -= pull
    return Q


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_steps_end_at_the_dense_solution(share: float) -> None:
    rng = np.random.default_rng(1)
    c, ridge = rng.uniform(0.5e-3, 5e-3, (M, N)), 1.0
    y, w = rng.normal(0, 0.1, (M, N)), rng.uniform(1e2, 1e4, (M, N)) * (rng.random((M, N)) < share)
    f = rng.normal(size=(M, N))
    settle(f, w, y, *links(c, R), ridge, weights(2000, 1e-4, 2.0))
    A = precision(c) + np.diag(w.ravel()) + ridge * np.eye(M * N)
    assert np.allclose(f.ravel(), np.linalg.solve(A, (w * y).ravel()), atol=1e-8)


def test_turning_the_observations_turns_the_heights() -> None:
    """By any number of lines, to the last bit: no order of lines decides."""
    rng = np.random.default_rng(2)
    c, y, w = rng.uniform(1e-3, 5e-3, (M, N)), rng.normal(size=(M, N)), rng.uniform(0, 1e3, (M, N))
    steps, f = weights(4, 0.3, 2.0), np.zeros((M, N))
    settle(f, w, y, *links(c, R), 1.0, steps)
    for turn in range(1, M):
        turned = np.zeros((M, N))
        c2, y2, w2 = (np.roll(a, turn, 0) for a in (c, y, w))
        settle(turned, w2, y2, *links(c2, R), 1.0, steps)
        assert np.array_equal(turned, np.roll(f, turn, 0))
