"""Static things in the world: poles and walls that follow the ground."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from scenarios import spec
from sim.scene.bodies import materials as m
from sim.scene.bodies.primitives import Shell, loft
from sim.scene.terrain import Terrain

ROOT = 0.3  # things reach so far into the ground, so that no gap shows under them [m]
PANEL = 1.0  # a wall bends with the ground about every so many metres


def shape(thing: spec.Thing, terrain: Terrain) -> Shell:
    """The thing's surface [m, world]; `size` above the ground, and a root below it."""
    return _pole(thing, terrain) if thing.kind == "pole" else _wall(thing, terrain)


def _pole(thing: spec.Thing, terrain: Terrain) -> Shell:
    """An elliptic cylinder, length x width across."""
    turn = 2 * np.pi * np.arange(12) / 12
    length, width, height = thing.size
    ring = np.column_stack([length / 2 * np.cos(turn), width / 2 * np.sin(turn)])
    foot = float(terrain.height_at(np.array([thing.at]))[0])
    xy = _placed(thing, ring)
    levels = (foot - ROOT, foot + height)
    return loft(np.stack([np.column_stack([xy, np.full(12, z)]) for z in levels]), m.STEEL)


def _wall(thing: spec.Thing, terrain: Terrain) -> Shell:
    """A cuboid whose foot and crest follow the ground under its middle line."""
    length, width, height = thing.size
    x = np.linspace(-length / 2, length / 2, max(int(np.ceil(length / PANEL)), 1) + 1)
    ground = terrain.height_at(_placed(thing, np.column_stack([x, np.zeros(len(x))])))
    section = ((-0.5, -ROOT), (0.5, -ROOT), (0.5, height), (-0.5, height))
    corners = [
        np.column_stack([_placed(thing, np.column_stack([x, np.full(len(x), y * width)])), ground + z])
        for y, z in section
    ]
    return loft(np.stack(corners, 1), m.CONCRETE)


def _placed(thing: spec.Thing, xy: F64) -> F64:
    """(n, 2) from the thing's own axes to the world's."""
    c, s = np.cos(np.radians(thing.yaw_deg)), np.sin(np.radians(thing.yaw_deg))
    x, y = xy[:, 0], xy[:, 1]
    return np.asarray(np.column_stack([c * x - s * y, s * x + c * y]) + np.array(thing.at))
