"""Porous foliage: small triangles turned every way, so that part of the rays pass between them.

A beam along a path L through leaves of area density u [m2/m3] passes with probability exp(-G u L),
G = 0.5 for leaves turned every way (Monsi and Saeki 1953, after Beer and Lambert; of single trees: Zhang et
al., Building and Environment 245 (2023) 110811). A triangle stands for a spray of leaves.
"""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64

EQUILATERAL = np.sqrt(3) / 4
"""Area of an equilateral triangle over its side squared."""
WAVES = 6  # of the field that clumps leaves together


def sprays(area: float, side: float, most: int) -> tuple[int, float]:
    """How many triangles make up a leaf area [m2], and their side [m]; larger where `most` are too few."""
    count = max(round(area / (EQUILATERAL * side**2)), 1)
    return (count, side) if count <= most else (most, float(np.sqrt(area / (most * EQUILATERAL))))


def leaves(middles: F64, side: float, rng: np.random.Generator) -> F64:
    """Equilateral triangles (n, 3, 3) about middles (n, 3) [m], turned every way."""
    n = len(middles)
    a, b = directions(n, rng), directions(n, rng)
    b -= np.sum(a * b, 1)[:, None] * a
    b /= np.sqrt(np.sum(b**2, 1))[:, None]
    turn = 2 * np.pi * np.arange(3) / 3
    corner = np.cos(turn)[:, None] * a[:, None] + np.sin(turn)[:, None] * b[:, None]
    return np.asarray(middles[:, None] + side / np.sqrt(3) * corner)


def directions(n: int, rng: np.random.Generator) -> F64:
    """Unit vectors (n, 3), evenly over the sphere."""
    z, turn = rng.uniform(-1, 1, n), rng.uniform(0, 2 * np.pi, n)
    r = np.sqrt(1 - z**2)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


def in_ball(n: int, rng: np.random.Generator) -> F64:
    """Points (n, 3) evenly in the unit ball."""
    return directions(n, rng) * np.cbrt(rng.uniform(0, 1, n))[:, None]


def in_cone(n: int, rng: np.random.Generator) -> F64:
    """Points (n, 3) evenly in a cone of radius 1 about z, from its base at z = 0 to its tip at 1."""
    z, turn = 1 - np.cbrt(rng.uniform(0, 1, n)), rng.uniform(0, 2 * np.pi, n)
    r = (1 - z) * np.sqrt(rng.uniform(0, 1, n))
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


def clumped(points: F64, keep: int, scale: float, rng: np.random.Generator) -> F64:
    """The `keep` of points (n, 3) that lie thickest in a random field of clumps about `scale` apart [m]."""
    waves = directions(WAVES, rng) * (2 * np.pi / (scale * rng.uniform(0.7, 1.5, WAVES)))[:, None]
    phase = rng.uniform(0, 2 * np.pi, WAVES)
    field = sum(
        np.cos(points[:, 0] * k[0] + points[:, 1] * k[1] + points[:, 2] * k[2] + p)
        for k, p in zip(waves, phase, strict=True)
    )
    weight = field + rng.normal(0, 1.0, len(points))
    return points[np.sort(np.argsort(-weight, kind="stable")[:keep])]
