from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from datmo.messages import FalseReturn
from sim.scan.effects.edges import EDGE, NEIGHBOURS, OFF, PULSE, SHARE, mix_edges
from sim.scan.luck import Luck
from sim.scan.pattern import pattern
from sim.scan.units import unit

GRID = pattern(unit("vlp-16"), 20)
SEED = np.random.SeedSequence(5)


def scene(gap: float) -> tuple[SimpleNamespace, SimpleNamespace, SimpleNamespace]:
    """Posts of actor 0, two columns wide, before a wall `gap` behind them."""
    L, C = len(GRID.elevation), GRID.columns
    front = np.broadcast_to(np.arange(C) % 8 < 2, (L, C)) & (np.arange(L) < 12)[:, None]
    winner = np.where(front, 0, -3).astype(np.int32).ravel()
    distance = np.where(front, 10.0, 10.0 + gap).astype(np.float32).ravel()
    hits = SimpleNamespace(distance=distance, winner=winner)
    met = SimpleNamespace(thing=np.where(winner == -3, 7, -1).astype(np.int32))
    returns = SimpleNamespace(distance=distance.copy(), false=np.zeros(L * C, np.uint8))
    return hits, met, returns


def reference(
    hits: SimpleNamespace, met: SimpleNamespace, divergence: float
) -> tuple[np.ndarray, np.ndarray]:
    """The model in plain Python."""
    L, C = len(GRID.elevation), GRID.columns
    luck = Luck(SEED)
    edge, share = luck.uniform(EDGE, L * C), luck.uniform(SHARE, L * C)
    distance, false = hits.distance.copy(), np.zeros(L * C, np.uint8)
    across = np.minimum(divergence / 2 / (2 * np.pi / C * np.cos(GRID.elevation)), 0.5)
    up = np.minimum(divergence / 2 / -np.diff(GRID.elevation), 0.5)
    for r in range(L * C):
        i, j, left = r // C, r % C, float(edge[r])
        for di, dj in NEIGHBOURS:
            a, b = i + di, j + dj
            if not (0 <= a < L and 0 <= b < C):
                continue
            left -= across[i] if di == 0 else up[min(i, a)]
            if left >= 0:
                continue
            n = a * C + b
            gap = float(hits.distance[n]) - float(hits.distance[r])
            other = hits.winner[n] != hits.winner[r] or met.thing[n] != met.thing[r]
            if other and abs(gap) < PULSE:
                moved = 0.5 * float(share[r]) * gap
                distance[r] += np.float32(moved)
                if abs(moved) > OFF and abs(gap - moved) > OFF:
                    false[r] = FalseReturn.MIXED_EDGE
            break
    return distance, false


def test_the_kernel_is_the_model() -> None:
    hits, met, returns = scene(0.6)
    mix_edges(GRID, hits, met, returns, 1.5e-3, Luck(SEED))
    distance, false = reference(hits, met, 1.5e-3)
    np.testing.assert_array_equal(returns.distance, distance)
    np.testing.assert_array_equal(returns.false, false)
    assert (returns.distance != hits.distance).sum() > 100
    assert returns.false.any()


def test_mixed_points_lie_between_the_surfaces_and_nowhere_else() -> None:
    hits, met, returns = scene(0.6)
    mix_edges(GRID, hits, met, returns, 1.5e-3, Luck(SEED))
    assert returns.distance.min() >= 10.0
    assert returns.distance.max() <= np.float32(10.6)
    off = returns.false > 0
    assert ((returns.distance[off] > 10.0 + OFF) & (returns.distance[off] < 10.6 - OFF)).all()
    column = np.arange(len(off)) % GRID.columns % 8
    inner = np.isin(column, (3, 4, 5, 6)) & (np.arange(len(off)) // GRID.columns < 11)
    assert (returns.distance[inner] == hits.distance[inner]).all()


def test_as_many_are_mixed_as_the_beam_is_wide() -> None:
    """A column at an edge: the chance is half the beam over the step."""
    hits, met, returns = scene(0.5)
    mix_edges(GRID, hits, met, returns, 1.2e-3, Luck(SEED))
    ring, column = np.divmod(np.arange(len(returns.distance)), GRID.columns)
    edge = (column % 8 == 2) & (ring < 10) & (column < GRID.columns - 8)
    step = 2 * np.pi / GRID.columns * np.cos(GRID.elevation[:10]).mean()
    share = (returns.distance[edge] != hits.distance[edge]).mean()
    assert share == pytest.approx(0.6e-3 / step, abs=4 * np.sqrt(0.1 / edge.sum()))


@pytest.mark.parametrize("gap", [0.0, PULSE + 0.01, 30.0])
def test_far_echoes_stay_apart(gap: float) -> None:
    hits, met, returns = scene(gap)
    mix_edges(GRID, hits, met, returns, 1.5e-3, Luck(SEED))
    np.testing.assert_array_equal(returns.distance, hits.distance)
    assert not returns.false.any()


def test_lost_rays_stay_lost() -> None:
    hits, met, returns = scene(0.6)
    returns.distance[::3] = 0
    mix_edges(GRID, hits, met, returns, 1.5e-3, Luck(SEED))
    assert (returns.distance[::3] == 0).all()
