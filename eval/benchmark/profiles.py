"""Profiles of one polar segment whose lines are known, as an HDL-64 would sample them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from datmo.arrays import F64
from datmo.bins import SENSOR_HEIGHT, bin_edges

KINDS = ("slopes", "kerbs", "plateaus", "obstacles")
PIECES = (2, 8)
STEEPEST, LEAST_TURN = 0.25, 0.06
LEAST_POINTS = 8
EMPTY = 0.15
NOISE = (0.01, 0.02)
KERB, PLATEAU = (0.12, 0.2), (0.6, 1.5)
OBSTACLES, OBSTACLE_POINTS, OBSTACLE_HEIGHT = (2, 5), (1, 3), (0.2, 1.5)


@dataclass(frozen=True)
class Profile:
    """Ordered candidates r, z (n,) [m, sensor] and the true lines (k, 4): start, end, slope, intercept.

    Start and end are the first and the last point that lies on the line.
    """

    kind: str
    r: F64
    z: F64
    lines: F64


def make_profile(kind: str, rng: np.random.Generator, noise: float | None = None) -> Profile:
    """A random ground of 2 to 8 lines under a sensor 1.73 m up.

    Neighbours differ by 0.06 in slope at least (3.4 degrees) and each line has 8 candidates or more;
    15 % of the bins are empty. "kerbs" jump by 0.12-0.2 m between some lines, "plateaus" raise some
    by 0.6-1.5 m, "obstacles" lift 2 to 5 stretches of 1 to 3 candidates by 0.2-1.5 m.

    Args:
        kind: of `KINDS`. noise: standard deviation of z [m]; None draws from 0.01-0.02.
    """
    edges = bin_edges()
    r = rng.uniform(edges[:-1], edges[1:])[rng.random(len(edges) - 1) >= EMPTY]
    cuts = _cuts(len(r), int(rng.integers(PIECES[0], PIECES[1] + 1)), rng)
    slopes = _slopes(len(cuts) - 1, rng)
    rises = _rises(kind, len(slopes), rng)
    z, lines, foot, at = np.empty(len(r)), np.empty((len(slopes), 4)), -SENSOR_HEIGHT, 0.0
    for k, (a, b) in enumerate(pairwise(cuts)):
        end = 0.5 * (r[b - 1] + r[b]) if b < len(r) else r[b - 1]
        intercept = foot + rises[k] - slopes[k] * at
        z[a:b] = slopes[k] * r[a:b] + intercept
        lines[k] = r[a], r[b - 1], slopes[k], intercept
        foot, at = foot + slopes[k] * (end - at) + (rises[k] if kind == "kerbs" else 0.0), end
    if kind == "obstacles":
        _lift(z, rng)
    scatter = rng.uniform(*NOISE) if noise is None else noise
    return Profile(kind, r, z + rng.normal(0, 1, len(r)) * scatter, lines)


def _cuts(n: int, pieces: int, rng: np.random.Generator) -> list[int]:
    """First points of the pieces and n behind them; each has `LEAST_POINTS` or more."""
    spare = n - pieces * LEAST_POINTS
    inner = np.sort(rng.integers(0, spare + 1, pieces - 1)) + LEAST_POINTS * np.arange(1, pieces)
    return [0, *inner.tolist(), n]


def _slopes(pieces: int, rng: np.random.Generator) -> F64:
    """Slopes (pieces,) [m/m]; the first is gentle, neighbours differ by `LEAST_TURN` or more."""
    slopes = [rng.uniform(-0.05, 0.05)]
    while len(slopes) < pieces:
        slope = rng.uniform(-STEEPEST, STEEPEST)
        if abs(slope - slopes[-1]) >= LEAST_TURN:
            slopes.append(slope)
    return np.array(slopes)


def _rises(kind: str, pieces: int, rng: np.random.Generator) -> F64:
    """Step at the start of each piece (pieces,) [m]: a kerb stays, a plateau ends with its piece."""
    odd = np.arange(pieces) % 2 == 1
    if kind == "kerbs":
        return np.where(odd, rng.choice([-1, 1], pieces) * rng.uniform(*KERB, pieces), 0)
    return np.where(odd, rng.uniform(*PLATEAU, pieces), 0) if kind == "plateaus" else np.zeros(pieces)


def _lift(z: F64, rng: np.random.Generator) -> None:
    """Put obstacles in front of the ground, in place."""
    for _ in range(rng.integers(OBSTACLES[0], OBSTACLES[1] + 1)):
        a = rng.integers(0, len(z) - OBSTACLE_POINTS[1])
        width = rng.integers(OBSTACLE_POINTS[0], OBSTACLE_POINTS[1] + 1)
        z[a : a + width] += rng.uniform(*OBSTACLE_HEIGHT)
