"""Hills and potholes strewn at random: a Poisson process on squares of the world's own lattice.

Each square draws from a stream of its own, so the ground is the same wherever an area begins and ends.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenarios.spec import layers as spec
from sim.scene.terrain.grid import Area
from sim.scene.terrain.shapes import BELL

SIDE = 100.0
"""Of a square of the lattice [m]: a hectare, the unit of the layers' density."""


def hills(layer: spec.Hills, area: Area, seed: np.random.SeedSequence) -> list[spec.Hill]:
    """The hills that reach into an area."""
    made = []
    for rng in _squares(area, BELL * layer.radius[1], seed):
        for x, y in rng.place(layer.density):
            height, radius = rng.pick(layer.height), rng.pick(layer.radius)
            made.append(spec.Hill(at=(x, y), height=height, radius=radius))
    return made


def potholes(layer: spec.Potholes, area: Area, seed: np.random.SeedSequence) -> list[spec.Pothole]:
    """The potholes that reach into an area, wherever they lie."""
    made = []
    for rng in _squares(area, layer.radius[1], seed):
        for x, y in rng.place(layer.density):
            depth, radius = rng.pick(layer.depth), rng.pick(layer.radius)
            made.append(spec.Pothole(at=(x, y), depth=depth, radius=radius))
    return made


class _Square:
    """The luck of one square."""

    def __init__(self, i: int, j: int, seed: np.random.SeedSequence) -> None:
        key = (*seed.spawn_key, *(2 * abs(v) + (v < 0) for v in (i, j)))
        self._rng = np.random.default_rng(np.random.SeedSequence(seed.entropy, spawn_key=key))
        self._corner = SIDE * i, SIDE * j

    def place(self, density: float) -> list[tuple[float, float]]:
        """Places [m, world]; `density` is their mean number."""
        places = self._rng.uniform(0, SIDE, (int(self._rng.poisson(density)), 2)) + self._corner
        return [(float(x), float(y)) for x, y in places]

    def pick(self, ends: tuple[float, float]) -> float:
        """A number between two."""
        return float(self._rng.uniform(*ends))


def _squares(area: Area, margin: float, seed: np.random.SeedSequence) -> Iterator[_Square]:
    low = [int(np.floor((v - margin) / SIDE)) for v in area[:2]]
    high = [int(np.floor((v + margin) / SIDE)) for v in area[2:]]
    for j in range(low[1], high[1] + 1):
        for i in range(low[0], high[0] + 1):
            yield _Square(i, j, seed)
