"""Static things (poles, walls) as one mesh that stands on the terrain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from datmo.arrays import F32, F64, I32, U8
from datmo.geometry import rotation_z
from datmo.messages import Kind
from scenarios.spec import Thing

SUNK = 0.5  # things reach that far below the lowest ground under them [m]
SIDES = {"pole": 12, "wall": 4}
KIND = {"pole": Kind.POLE, "wall": Kind.WALL}


class Ground(Protocol):
    """Terrain, as far as things need it."""

    def height_at(self, xy: F64) -> F64:
        """Height (n,) [m, world] at (n, 2)."""


@dataclass(frozen=True, eq=False)
class Things:
    """All static things of a run. Per triangle: `thing` (t,) the id, `kind` (t,)."""

    vertices: F32
    triangles: I32
    thing: I32
    kind: U8


def _prism(outline: F64, bottom: float, top: float) -> tuple[F64, I32]:
    """A closed upright prism over a counter-clockwise outline (m, 2)."""
    m = len(outline)
    low = np.column_stack([outline, np.full(m, bottom)])
    high = np.column_stack([outline, np.full(m, top)])
    i, j = np.arange(m), (np.arange(m) + 1) % m
    sides = np.concatenate([np.column_stack([i, j, m + j]), np.column_stack([i, m + j, m + i])])
    fan = np.arange(1, m - 1)
    lid = np.column_stack([np.full(m - 2, m), m + fan, m + fan + 1])
    floor = np.column_stack([np.zeros(m - 2, int), fan + 1, fan])
    return np.concatenate([low, high]), np.concatenate([sides, lid, floor]).astype(np.int32)


def _outline(thing: Thing) -> F64:
    """The thing from above, counter-clockwise (m, 2) [m, world]."""
    sides = SIDES[thing.kind]
    angle = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    unit = np.column_stack([np.cos(angle), np.sin(angle)]) / np.cos(np.pi / sides)
    local = unit * np.array(thing.size[:2]) / 2
    R = rotation_z(np.deg2rad(thing.yaw_deg))[:2, :2]
    return np.asarray(local @ R.T + np.array(thing.at))


def place(things: Sequence[Thing], ground: Ground) -> Things | None:
    """Build the things; thing i has id i and its height counted from the ground at its middle.

    Poles have twelve sides around their ellipse, walls four. None where there are no things.
    """
    vertices, triangles, ids, kinds, count = [], [], [], [], 0
    for i, thing in enumerate(things):
        outline = _outline(thing)
        base = float(ground.height_at(np.array([thing.at], float))[0])
        bottom = min(base, float(ground.height_at(outline).min())) - SUNK
        v, t = _prism(outline, bottom, base + thing.size[2])
        vertices.append(v)
        triangles.append(t + count)
        ids.append(np.full(len(t), i, np.int32))
        kinds.append(np.full(len(t), KIND[thing.kind], np.uint8))
        count += len(v)
    if not vertices:
        return None
    mesh = np.concatenate(vertices).astype(np.float32), np.concatenate(triangles).astype(np.int32)
    return Things(*mesh, np.concatenate(ids), np.concatenate(kinds))
