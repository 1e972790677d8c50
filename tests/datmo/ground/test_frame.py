"""The whole-frame objective and its gradients, for every method and every objective."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.ground import GroundConfig
from datmo.ground.fields import Supports, along
from datmo.ground.frame import FrameObjective, climb
from datmo.ground.grid import PolarGrid
from datmo.ground.latent import OBJECTIVES
from datmo.ground.regression import Cells
from datmo.ground.selection import fullest, pack, pseudo_inputs
from datmo.ground.z import LineLengths, OneLength
from datmo.ground.zl import LatentLengths, LatentLengthsAndNoise

M, N, NODES = 5, 14, 7


def cells(seed: int = 0) -> Cells:
    """Rough profiles of 5 segments, one of them empty and one with a single cell."""
    rng = np.random.default_rng(seed)
    r = np.sort(rng.uniform(3, 40, (M, N)), 1)
    y = 0.1 * np.sin(r / rng.uniform(2, 6, (M, 1))) + rng.normal(0, 0.02, (M, N))
    use = rng.random((M, N)) < 0.8
    use[1], use[2, 1:], use[2, 0] = False, False, True
    return Cells(r, y, use)


GRID = PolarGrid(M, np.linspace(2, 42, NODES - 1))
METHODS = {"z": LineLengths, "z-se": OneLength, "zl": LatentLengths, "zli": LatentLengthsAndNoise}


def problem(method: str, objective: str = "whitened", truncated: bool = False) -> FrameObjective:
    config = GroundConfig(objective=objective, truncated=truncated, supports=4, support_angle=1.0)
    regression = METHODS[method](GRID, config)
    data = cells()
    if method in ("z", "z-se"):
        return regression.objective(data, regression.shape(data)[0])
    return regression.objective(data, regression._means(data)[0])[0]


def somewhere(objective: FrameObjective) -> np.ndarray:
    """θ with lively values everywhere."""
    lively = {"sigma_f": 0.2, "sigma_n": 0.04, "length": 4.0, "a": 1.3}
    lively |= {"bar_sigma_f": 0.6, "bar_sigma_l": 7.0, "bar_sigma_n": 0.3}
    lively |= {"bar_sigma_f_noise": 0.4, "bar_sigma_l_noise": 9.0, "bar_sigma_n_noise": 0.2}
    free = objective.length.free + objective.noise.free
    return objective.theta(lively, [np.random.default_rng(1).normal(0, 0.5, free)])


def differences(objective: FrameObjective, theta: np.ndarray) -> np.ndarray:
    """Central differences of fourth order."""
    out, h = np.zeros(len(theta)), 1e-3
    for k in range(len(theta)):
        d = np.zeros(len(theta))
        d[k] = h
        f = [objective(theta + s * d)[0] for s in (-2, -1, 1, 2)]
        out[k] = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h)
    return out


@pytest.mark.parametrize("objective", list(OBJECTIVES))
@pytest.mark.parametrize("method", list(METHODS))
def test_gradient_is_that_of_finite_differences(method: str, objective: str) -> None:
    f = problem(method, objective)
    theta = somewhere(f)
    gradient = f(theta)[1]
    assert np.abs(gradient[: len(f.names)]).min() > 1e-5  # every shared parameter matters
    assert np.abs(gradient - differences(f, theta)).max() < 1e-6 * np.abs(gradient).max()


@pytest.mark.parametrize("objective", list(OBJECTIVES))
def test_truncation_leaves_out_the_terms_through_the_latent_process_only(objective: str) -> None:
    whole, cut = problem("zl", objective), problem("zl", objective, True)
    theta = somewhere(whole)
    (value, full), (same, short) = whole(theta), cut(theta)
    latent = [k for k, name in enumerate(whole.names) if name.startswith("bar_")]
    others = np.setdiff1d(np.arange(len(theta)), latent)
    assert value == same
    assert np.array_equal(full[others], short[others])
    assert (full[latent] != short[latent]).all()
    if objective == "whitened":  # nothing but those terms
        assert np.array_equal(short[latent], np.zeros(3))


def textbook(
    objective: str, f: FrameObjective, theta: np.ndarray, supports: Supports, means: np.ndarray
) -> float:
    """zl's 𝓛 in dense numpy, segment by segment."""
    h, total, at = f.hyper(theta), 0.0, len(f.names)
    for m in range(M):
        n, p = int(f.cells.count[m]), int(supports.count[m])
        r, z, rb, x = f.cells.r[m, :n], f.cells.y[m, :n], supports.r[m, :p], theta[at : at + p]
        at += p

        def latent(a: np.ndarray, b: np.ndarray) -> np.ndarray:
            return h["bar_sigma_f"] ** 2 * np.exp(-((a[:, None] - b) ** 2) / (2 * h["bar_sigma_l"] ** 2))

        B = latent(rb, rb) + h["bar_sigma_n"] ** 2 * np.eye(p)
        C = np.linalg.cholesky(B)
        delta = C @ x if objective == "whitened" else x
        L = h["a"] * np.exp(means[m, f.cells.bin[m, :n]] + latent(r, rb) @ np.linalg.solve(B, delta))
        S = L[:, None] ** 2 + L**2
        K = np.sqrt(2 * np.outer(L, L) / S) * np.exp(-2 * (r[:, None] - r) ** 2 / S)
        A = h["sigma_f"] ** 2 * K + h["sigma_n"] ** 2 * np.eye(n)
        total -= 0.5 * (z @ np.linalg.solve(A, z) + np.linalg.slogdet(A)[1] + n * np.log(2 * np.pi))
        if objective == "whitened":
            total -= 0.5 * x @ x
        else:
            total -= 0.5 * np.linalg.slogdet(B)[1]
            total -= 0.5 * delta @ np.linalg.solve(B, delta) if objective == "prior" else 0.0
    return float(total)


@pytest.mark.parametrize("objective", list(OBJECTIVES))
def test_objective_is_the_textbooks(objective: str) -> None:
    config = GroundConfig(objective=objective, supports=4, support_angle=1.0)
    regression = LatentLengths(GRID, config)
    means = regression._means(cells())[0]
    f, _, supports = regression.objective(cells(), means)
    theta = somewhere(f)
    assert f(theta)[0] == pytest.approx(textbook(objective, f, theta, supports, means), rel=1e-8)


@pytest.mark.parametrize("method", list(METHODS))
def test_a_climb_climbs_and_stays_within_bounds(method: str) -> None:
    f = problem(method)
    theta = somewhere(f)
    short, long = climb(f, theta, 3), climb(f, theta, 40)
    assert f(theta)[0] < short.value < long.value
    shared = np.exp(long.theta[: len(f.names)])
    low, high = np.array(f.bounds).T
    assert (shared >= low * (1 - 1e-9)).all()
    assert (shared <= high * (1 + 1e-9)).all()


def test_the_printed_objective_runs_into_a_bound_and_says_so() -> None:
    f = problem("zl", "printed")
    found = climb(f, somewhere(f), 200)
    assert any("bar_sigma" in note and "lower bound" in note for note in found.notes)


def test_without_freedom_zl_is_a_process_of_line_lengths() -> None:
    """u = 0: the latent process vanishes, whatever its hyper-parameters."""
    f = problem("zl")
    theta = somewhere(f)
    theta[len(f.names) :] = 0
    other = theta.copy()
    other[[k for k, name in enumerate(f.names) if name.startswith("bar_")]] += 0.3
    assert f(theta)[0] == f(other)[0]


def test_the_factor_on_the_line_length_can_be_held_at_one() -> None:
    regression = LatentLengths(GRID, GroundConfig(line_factor=False, supports=4))
    f = regression.objective(cells(), regression._means(cells())[0])[0]
    found = climb(f, somewhere(f), 10)
    assert f.hyper(found.theta)["a"] == 1
    assert regression.start().hyper["a"] == 1


def test_cells_are_thinned_evenly_from_the_first_to_the_last() -> None:
    data = cells()
    packed = pack(data, np.arange(M), 5)
    for m in range(M):
        seen = np.flatnonzero(data.use[m])
        assert packed.count[m] == min(len(seen), 5)
        chosen = packed.bin[m, : packed.count[m]]
        assert set(chosen) <= set(seen)
        if len(seen) > 5:
            assert (chosen[0], chosen[-1]) == (seen[0], seen[-1])
    assert np.array_equal(pack(data, np.arange(M), N).count, data.use.sum(1))


def test_fullest_segments_turn_with_the_cloud() -> None:
    data = cells(3)
    turned = Cells(*(np.roll(a, 2, 0) for a in (data.r, data.y, data.use)))
    assert np.array_equal((fullest(data, 2) + 2) % M, fullest(turned, 2))
    assert len(fullest(data, 9)) == 3  # neither the empty one nor the single cell


@pytest.mark.parametrize("angle", [0.02, 0.1, 1.0])
def test_pseudo_inputs_lie_about_the_mean_vertical_angle(angle: float) -> None:
    data = cells()
    supports = pseudo_inputs(data, -1.73, angle, 60)
    for m in range(M):
        r, y = data.r[m][data.use[m]], data.y[m][data.use[m]]
        v = np.arctan2(y - 1.73, r)
        want = r[np.abs(v - v.mean()) <= angle] if len(r) else r
        assert np.array_equal(supports.r[m, : supports.count[m]], want)
    assert pseudo_inputs(data, -1.73, angle, 2).count.max() <= 2


def test_carried_values_are_interpolated() -> None:
    nodes = np.array([0.0, 1.0, 3.0])
    assert along(nodes, np.array([[0.0, 2.0, 0.0]]), np.array([[0.5, 2.0, 9.0]])).tolist() == [
        [1.0, 1.0, 0.0]
    ]


def test_no_cells_at_all_are_worth_nothing() -> None:
    nothing = Cells(np.ones((M, N)), np.ones((M, N)), np.zeros((M, N), bool))
    f = OneLength(GRID, GroundConfig()).objective(nothing, np.ones((M, N)))
    value, gradient = f(np.zeros(3))
    assert value == 0
    assert np.array_equal(gradient, np.zeros(3))
