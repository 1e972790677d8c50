"""The lattice solver against slow dense algebra."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.ground.chebyshev import weights
from datmo.ground.lattice import Lattice, corners, evaluate, factor, gather, prior, relax

LATTICE = Lattice(9, np.array([3.0, 4.0, 5.5, 6.0, 9.0, 13.0, 14.5]))
M, N = LATTICE.lines, len(LATTICE.radii)
SEGMENTS = 27
BEND, SLOPE, RIDGE, NOISE = 0.7, 1.6, 2.5, 0.3


def energy(f: np.ndarray) -> float:
    """The prior's part of the objective, term by term, in units of 1 / noise²."""
    r = LATTICE.radii
    area, arc = np.gradient(r) * r * 2 * np.pi / M, r * 2 * np.pi / M
    total = 0.0
    for m in range(M):
        for b in range(N):
            across2 = (f[m - 1, b] - 2 * f[m, b] + f[(m + 1) % M, b]) / arc[b] ** 2
            across1 = (f[(m + 1) % M, b] - f[m, b]) / arc[b]
            total += area[b] * ((across2 / BEND) ** 2 + (across1 / SLOPE) ** 2) + (f[m, b] / RIDGE) ** 2
        for b in range(1, N - 1):
            before, after = r[b] - r[b - 1], r[b + 1] - r[b]
            turn = (f[m, b + 1] - f[m, b]) / after - (f[m, b] - f[m, b - 1]) / before
            total += area[b] * (turn / ((before + after) / 2) / BEND) ** 2
        for b in range(N - 1):
            rise = (f[m, b + 1] - f[m, b]) / (r[b + 1] - r[b])
            total += (area[b] + area[b + 1]) / 2 * (rise / SLOPE) ** 2
    return float(NOISE**2 * total)


def prior_matrix() -> np.ndarray:
    """(M N, M N) of that energy, by polarisation."""
    eye = np.eye(M * N).reshape(-1, M, N)
    own = np.array([energy(e) for e in eye])
    A = np.diag(own)
    for i in range(M * N):
        for j in range(i):
            A[i, j] = A[j, i] = (energy(eye[i] + eye[j]) - own[i] - own[j]) / 2
    return A


def basis(azimuth: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """(n, M N) bilinear shares: hat functions of the line and of the radius."""
    lines = (np.arange(M) + 0.5) * SEGMENTS / M
    gap = np.abs((azimuth[:, None] - lines + SEGMENTS / 2) % SEGMENTS - SEGMENTS / 2) * M / SEGMENTS
    by_line = np.maximum(1 - gap, 0)
    by_radius = np.array([np.interp(radius, LATTICE.radii, e) for e in np.eye(N)]).T
    return np.asarray((by_line[:, :, None] * by_radius[:, None]).reshape(len(azimuth), M * N))


def places(n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Azimuths and radii, some of them within the first and beyond the last radius."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0, SEGMENTS, n), rng.uniform(2, 16, n)


def test_evaluate_is_bilinear_and_holds_beyond_the_radii() -> None:
    f = np.random.default_rng(0).normal(size=(M, N))
    azimuth, radius = places(300, 1)
    azimuth[:3] = 0.0, 1.5, SEGMENTS - 1e-9
    got = evaluate(f, *corners(azimuth, radius, M, SEGMENTS, LATTICE.radii))
    assert np.allclose(got, basis(azimuth, radius) @ f.ravel(), atol=1e-12)


def test_prior_is_the_quadratic_form() -> None:
    """Read back from the bands: lines one and two off pull, what is held stands on the diagonal."""
    p = prior(LATTICE, BEND, SLOPE, RIDGE, NOISE)
    A = np.zeros((M, N, M, N))
    for m in range(M):
        for b in range(N):
            for k in range(3):
                if b + k < N:
                    A[m, b, m, b + k] = A[m, b + k, m, b] = p.bands[k, b]
            for step, pull in ((1, p.next), (2, p.second)):
                A[m, b, (m + step) % M, b] = A[m, b, m - step, b] = -pull[b]
    f = np.random.default_rng(2).normal(size=(5, M, N))
    for one in f:
        assert one.ravel() @ A.reshape(M * N, -1) @ one.ravel() == pytest.approx(energy(one), rel=1e-10)


@pytest.mark.parametrize("n", [0, 1, 40, 400])
def test_steps_end_at_the_dense_solution(n: int) -> None:
    rng = np.random.default_rng(n)
    azimuth, radius = places(n, n)
    y, w = rng.normal(size=n), rng.uniform(0.1, 3, n) * (rng.random(n) < 0.8)
    p = prior(LATTICE, BEND, SLOPE, RIDGE, NOISE)
    normal, f = np.empty((5, N, 1 + M)), rng.normal(size=(M, N))
    gather(w, y, *corners(azimuth, radius, M, SEGMENTS, LATTICE.radii), normal)
    relax(f, normal, factor(normal, p.bands), p.next, p.second, weights(3000, 1e-4, 8 / 3))
    B = basis(azimuth, radius)
    want = np.linalg.solve(prior_matrix() + B.T @ (w[:, None] * B), B.T @ (w * y))
    assert np.allclose(f.ravel(), want, atol=1e-8)


def test_turning_the_points_by_lines_turns_the_surface() -> None:
    """To the last bit but for the order of sums: no order of lines decides."""
    rng = np.random.default_rng(5)
    azimuth, radius = places(60, 6)
    y, w = rng.normal(size=60), rng.uniform(0.1, 3, 60)
    p = prior(LATTICE, BEND, SLOPE, RIDGE, NOISE)
    found = []
    for turn in range(M):
        at = (azimuth + turn * SEGMENTS / M) % SEGMENTS
        normal, f = np.empty((5, N, 1 + M)), np.zeros((M, N))
        gather(w, y, *corners(at, radius, M, SEGMENTS, LATTICE.radii), normal)
        relax(f, normal, factor(normal, p.bands), p.next, p.second, weights(4, 0.2, 8 / 3))
        found.append(np.roll(f, -turn, 0))
    np.testing.assert_allclose(found, np.broadcast_to(found[0], (M, M, N)), atol=1e-12)
