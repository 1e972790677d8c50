"""Triangles of a thing in its own axes, with kind and reflectivity, and how they follow the ground."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from datmo.arrays import F64, I64, U8
from datmo.messages import Kind
from sim.scene.bodies.primitives import Shell

ROOT = 0.3  # things reach so far into the ground, so that no gap shows under them [m]
Follow = Literal["stand", "bend", "drape"]
FOLLOW: dict[Follow, tuple[float, float]] = {"stand": (0.0, 0.0), "bend": (1.0, 0.0), "drape": (1.0, 1.0)}
"""Where each vertex takes its ground: at the thing's middle, on its middle line, or right below itself."""


@dataclass(frozen=True, eq=False)
class Form:
    """Triangles (t, 3) over vertices; thin ones (leaves, wires, plates) are seen from both sides.

    Args:
        vertices: (v, 3) [m], x and y about the thing's place, z above the ground.
        foot: (v, 2) place in the same axes whose ground carries the vertex [m].
        triangles: (t, 3). reflectivity: (t,) 0..1. kind: (t,) of datmo.messages.Kind.
    """

    vertices: F64
    foot: F64
    triangles: I64
    reflectivity: F64
    kind: U8


def solid(shell: Shell, kind: Kind, follow: Follow = "stand") -> Form:
    """A closed shell of one kind."""
    return Form(
        shell.vertices,
        shell.vertices[:, :2] * FOLLOW[follow],
        np.asarray(shell.triangles, np.int64),
        shell.reflectivity,
        np.full(len(shell.triangles), kind, np.uint8),
    )


def loose(corners: F64, kind: Kind, reflectivity: F64 | float, follow: Follow = "stand") -> Form:
    """Polygons (n, 3 or 4, 3) [m] that share no corners; quads become two triangles."""
    n, p = corners.shape[:2]
    fan = np.array([[0, i, i + 1] for i in range(1, p - 1)])
    vertices = np.ascontiguousarray(corners.reshape(-1, 3), float)
    triangles = (p * np.arange(n)[:, None, None] + fan).reshape(-1, 3)
    shades = np.repeat(np.broadcast_to(np.asarray(reflectivity, float), n), p - 2)
    foot = vertices[:, :2] * FOLLOW[follow]
    return Form(vertices, foot, triangles, shades, np.full(len(triangles), kind, np.uint8))


def join(forms: Sequence[Form]) -> Form:
    """All forms as one."""
    starts = np.cumsum([0, *(len(f.vertices) for f in forms)])
    return Form(
        np.concatenate([f.vertices for f in forms]),
        np.concatenate([f.foot for f in forms]),
        np.concatenate([f.triangles + k for f, k in zip(forms, starts[:-1], strict=True)]),
        np.concatenate([f.reflectivity for f in forms]),
        np.concatenate([f.kind for f in forms]),
    )


def upright(x: F64, width: float, bottom: F64, top: F64, y: float = 0.0) -> F64:
    """Quads (n, 4, 3) that stand across y at each x (n,), from bottom (n,) to top (n,) [m]."""
    left, right, across = x - width / 2, x + width / 2, np.full(len(x), y)
    corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
    return np.stack([np.stack([u, across, v], -1) for u, v in corners], 1)


def extruded(profile: F64, x: F64) -> F64:
    """Quads (n, 4, 3) of an open profile (p, 2) of y and z [m] drawn along x (m,)."""
    m, p = len(x), len(profile)
    grid = np.empty((m, p, 3))
    grid[..., 0], grid[..., 1:] = x[:, None], profile
    return np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], 2).reshape(-1, 4, 3)


def limb(start: F64, end: F64, radii: tuple[float, float], sides: int) -> F64:
    """Quads (sides, 4, 3) of a round limb between two points (3,) [m], open at its ends."""
    axis = (end - start) / np.sqrt(np.sum((end - start) ** 2))
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    across /= np.sqrt(np.sum(across**2))
    turn = 2 * np.pi * np.arange(sides) / sides
    ring = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * np.cross(axis, across)
    low, high = start + radii[0] * ring, end + radii[1] * ring
    return np.stack([low, np.roll(low, -1, 0), np.roll(high, -1, 0), high], 1)
