from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from datmo.messages import FalseReturn
from sim.scan.effects.edges import EDGE, OFF, PULSE, SHARE, SIDES, mix_edges
from sim.scan.effects.jumps import BEND, JUMP, shifts
from sim.scan.luck import Luck
from sim.scan.pattern import Pattern, pattern
from sim.scan.units import unit

GRID = pattern(unit("vlp-16"), 20)
STREET = pattern(unit("hdl64e-s3-xiesc"), 20)
SEED = np.random.SeedSequence(5)
NEAREST = 0.9

Scene = tuple[SimpleNamespace, SimpleNamespace, SimpleNamespace]


def seen(pattern: Pattern, distance: np.ndarray, rho: float | np.ndarray = 0.3) -> Scene:
    m = distance.size
    flat = distance.astype(np.float32).ravel()
    hits = SimpleNamespace(distance=flat)
    met = SimpleNamespace(reflectance=np.broadcast_to(np.float32(rho), m).copy())
    returns = SimpleNamespace(
        distance=np.where(np.isfinite(flat), flat, 0).astype(np.float32),
        hit=np.isfinite(flat),
        false=np.zeros(m, np.uint8),
        source=np.arange(m, dtype=np.int32),
    )
    return hits, met, returns


def posts(gap: float) -> Scene:
    """Posts two columns wide before a wall `gap` behind them, below nothing."""
    L, C = len(GRID.elevation), GRID.columns
    front = np.broadcast_to(np.arange(C) % 8 < 2, (L, C)) & (np.arange(L) < 12)[:, None]
    return seen(GRID, np.where(front, 10.0, 10.0 + gap))


def street(pattern: Pattern) -> Scene:
    """A rough ground with boxes on it and holes in it, of many brightnesses."""
    rng = np.random.default_rng(2)
    L, C = len(pattern.elevation), pattern.columns
    slope = 2 / np.maximum(np.sin(-pattern.elevation), 0.03)
    distance = slope[:, None] * (1 + 0.003 * rng.standard_normal((L, C)))
    for _ in range(60):
        i, j, h, w = rng.integers(0, L), rng.integers(0, C), rng.integers(1, 6), rng.integers(1, 30)
        distance[i : i + h, j : j + w] = rng.uniform(2, 30)
    distance[rng.random((L, C)) < 0.01] = np.inf
    return seen(pattern, distance, rng.uniform(0.05, 0.6, L * C))


def reference(grid: Pattern, scene: Scene, divergence: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The model in plain Python: distance, false, source."""
    hits, met, returns = scene
    L, C = len(grid.elevation), grid.columns
    luck, lag = Luck(SEED), shifts(grid)
    edge, share = luck.uniform(EDGE, L * C), luck.uniform(SHARE, L * C)
    distance, false, source = returns.distance.copy(), returns.false.copy(), returns.source.copy()
    across = np.minimum(divergence / 2 / (2 * np.pi / C * np.cos(grid.elevation)), 0.5)
    up = np.minimum(divergence / 2 / np.maximum(np.abs(np.diff(grid.elevation)), 1e-6), 0.5)
    true = hits.distance.astype(float)

    def neighbour(i: int, j: int, side: int, steps: int) -> int:
        a = i + steps * SIDES[side][0]
        if not 0 <= a < L:
            return -1
        b = j + steps * SIDES[side][1] + lag[a] - lag[i]
        return a * C + b if 0 <= b < C else -1

    def rise(a: int, b: int) -> float:
        known = a >= 0 and b >= 0 and np.isfinite(true[a]) and np.isfinite(true[b])
        return true[b] - true[a] if known else 0.0

    def cut(i: int, j: int, side: int) -> int:
        r, n = i * C + j, neighbour(i, j, side, 1)
        if n < 0:
            return -1
        slopes = rise(neighbour(i, j, side, -1), r), rise(n, neighbour(i, j, side, 2))
        slack = JUMP + BEND * max(abs(s) for s in slopes)
        return n if not min(slopes) - slack <= rise(r, n) <= max(slopes) + slack else -1

    for r in np.flatnonzero(returns.distance):
        i, j, left = r // C, r % C, float(edge[r])
        for side, (di, _) in enumerate(SIDES):
            left -= across[i] if di == 0 else up[min(i, i + di)] if 0 <= min(i, i + di) < L - 1 else 0.5
            if left >= 0:
                continue
            n = cut(i, j, side)
            if n < 0 or not NEAREST <= true[n] < np.inf:
                break
            part = 0.5 * float(share[r])
            mine = (1 - part) * met.reflectance[r] / true[r] ** 2
            other = part * met.reflectance[n] / true[n] ** 2
            gap, weight = true[n] - true[r], other / (mine + other)
            moved = gap * weight if abs(gap) < PULSE else gap * (weight > 0.5)
            distance[r] += np.float32(moved)
            if abs(gap - moved) < abs(moved):
                source[r] = n
            if abs(moved) > OFF and abs(gap - moved) > OFF:
                false[r] = FalseReturn.MIXED_EDGE
            break
    return distance, false, source


@pytest.mark.parametrize("grid", [GRID, STREET], ids=["even", "shifted"])
def test_the_kernel_is_the_model(grid: Pattern) -> None:
    scene = street(grid)
    distance, false, source = reference(grid, scene, 2e-3)
    hits, met, returns = scene
    before = returns.distance.copy()
    mix_edges(grid, hits, met, returns, 2e-3, NEAREST, Luck(SEED))
    np.testing.assert_allclose(returns.distance, distance, rtol=1e-6)
    np.testing.assert_array_equal(returns.false, false)
    np.testing.assert_array_equal(returns.source, source)
    assert (returns.distance != before).sum() > 30
    assert returns.false.any()
    assert (returns.source != np.arange(len(source))).any()


def test_mixed_points_lie_between_the_surfaces_and_nowhere_else() -> None:
    hits, met, returns = posts(0.6)
    mix_edges(GRID, hits, met, returns, 1.5e-3, NEAREST, Luck(SEED))
    assert returns.distance.min() >= 10.0
    assert returns.distance.max() <= np.float32(10.6)
    off = returns.false > 0
    assert ((returns.distance[off] > 10.0 + OFF) & (returns.distance[off] < 10.6 - OFF)).all()
    column = np.arange(len(off)) % GRID.columns % 8
    inner = np.isin(column, (3, 4, 5, 6)) & (np.arange(len(off)) // GRID.columns < 11)
    assert (returns.distance[inner] == hits.distance[inner]).all()


def test_as_many_are_mixed_as_the_beam_is_wide() -> None:
    """A column at an edge: the chance is half the beam over the step."""
    hits, met, returns = posts(0.5)
    mix_edges(GRID, hits, met, returns, 1.2e-3, NEAREST, Luck(SEED))
    ring, column = np.divmod(np.arange(len(returns.distance)), GRID.columns)
    edge = (column % 8 == 2) & (ring < 10) & (column < GRID.columns - 8)
    step = 2 * np.pi / GRID.columns * np.cos(GRID.elevation[:10]).mean()
    share = (returns.distance[edge] != hits.distance[edge]).mean()
    assert share == pytest.approx(0.6e-3 / step, abs=4 * np.sqrt(0.1 / edge.sum()))


@pytest.mark.parametrize("gap", [0.0, 0.9 * JUMP])
def test_a_fold_is_no_edge(gap: float) -> None:
    hits, met, returns = posts(gap)
    mix_edges(GRID, hits, met, returns, 1.5e-3, NEAREST, Luck(SEED))
    np.testing.assert_array_equal(returns.distance, hits.distance)


@pytest.mark.parametrize("gap", [PULSE + 0.01, 30.0])
def test_echoes_far_apart_do_not_merge(gap: float) -> None:
    """The nearer is brighter and may take a ray of the wall; none comes to lie between."""
    hits, met, returns = posts(gap)
    mix_edges(GRID, hits, met, returns, 1.5e-3, NEAREST, Luck(SEED))
    changed = returns.distance != hits.distance
    assert 0 < changed.mean() < 0.05
    np.testing.assert_allclose(returns.distance[changed], 10.0, rtol=1e-6)
    np.testing.assert_array_equal(returns.source[changed] != np.flatnonzero(changed), True)
    assert not returns.false.any()


def test_a_bright_surface_beside_a_dark_one_takes_its_edge() -> None:
    """A sign beside a black wall far behind: the wall's rays at the edge may report the sign."""
    hits, met, returns = posts(5.0)
    wall = hits.distance > 12
    met.reflectance[:] = np.where(wall, 0.02, 0.9)
    mix_edges(GRID, hits, met, returns, 1.5e-3, NEAREST, Luck(SEED))
    changed = returns.source != np.arange(len(wall))
    assert changed.sum() > 50
    assert wall[changed].all()
    np.testing.assert_allclose(returns.distance[changed], 10.0)
    assert not returns.false.any()


def test_a_plane_has_next_to_no_edge_however_it_is_tilted() -> None:
    d = STREET.directions
    for normal in ((0, 0, 1), (0.1, 0.05, 1), (1, 0, 0.1)):
        with np.errstate(divide="ignore"):
            t = -1.7 / (d @ np.array(normal) / np.linalg.norm(normal))
        distance = np.where((t > 0) & (t < 7), t, np.inf)  # not at grazing angles
        hits, met, returns = seen(STREET, distance)
        before = returns.distance.copy()
        mix_edges(STREET, hits, met, returns, 2e-3, NEAREST, Luck(SEED))
        assert (returns.distance != before).mean() < 1e-3  # where rings are unevenly spaced


def test_lost_rays_stay_lost() -> None:
    hits, met, returns = posts(0.6)
    returns.distance[::3], returns.hit[::3] = 0, False
    mix_edges(GRID, hits, met, returns, 1.5e-3, NEAREST, Luck(SEED))
    assert (returns.distance[::3] == 0).all()
