"""What runs along: walls, fences, guard rails, hedges. They bend with the ground under their middle line."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from datmo.messages import Kind
from sim.scene.bodies.primitives import Shell, loft
from sim.scene.scenery import materials as m
from sim.scene.scenery.form import ROOT, Form, extruded, join, loose, solid, upright
from sim.scene.scenery.leaves import leaves

Size = tuple[float, float, float]
PANEL = 1.0  # a wall bends with the ground about every so many metres
MAT, MESH = 2.51, (0.05, 0.2)
"""Double-bar mats: width of a panel, spacing of the upright and level wires [m]."""
WIRE = 0.016
"""Wires are 5-6 mm thick; drawn as wide as a beam, some centimetres across, answers to [m]."""
PICKET, BETWEEN = 0.09, 0.05  # of a wooden fence [m]
BEAM = np.array(
    [
        [-0.083, 0.0],
        [-0.02, 0.02],
        [0.0, 0.06],
        [0.0, 0.09],
        [-0.083, 0.156],
        [0.0, 0.222],
        [0.0, 0.252],
        [-0.02, 0.292],
        [-0.083, 0.312],
    ]
)
"""Depth and height of a W-beam, 83 x 312 mm (AASHTO M 180) [m]."""
POSTS = 1.905  # spacing along a W-beam (AASHTO M 180) [m]
LEAFAGE, SIDE = 60.0, 0.16
"""Sprays of leaves a square metre of a hedge's skin, and their side [m]."""


def wall(size: Size) -> Form:
    """A cuboid whose foot and crest follow the ground under its middle line."""
    return solid(_block(size, -ROOT, m.CONCRETE), Kind.WALL, "bend")


def fence(size: Size, seed: int) -> Form:
    """Posts with mats of wire mesh (even seeds) or wooden pickets (odd ones); rays pass between."""
    length, width, height = size
    posts = _posts(length, width, height, m.ZINC, MAT)
    x = np.linspace(-length / 2, length / 2, max(int(np.ceil(length / PANEL)), 1) + 1)
    if seed % 2:
        slat = _inside(length, PICKET + BETWEEN)
        low, high = np.full(len(slat), 0.06), np.full(len(slat), height)
        slats = upright(slat, PICKET, low, high, 0.02)
        boards = [extruded(np.array([[0.0, z], [0.0, z + 0.08]]), x) for z in (0.2 * height, 0.75 * height)]
        return join([posts, loose(np.concatenate([slats, *boards]), Kind.WALL, m.WOOD, "bend")])
    wire = _inside(length, MESH[0])
    wires = upright(wire, WIRE, np.full(len(wire), 0.03), np.full(len(wire), height))
    levels = np.arange(0.05, height - WIRE, MESH[1])
    level = [extruded(np.array([[0.005, z], [0.005, z + WIRE]]), x) for z in levels]
    return join([posts, loose(np.concatenate([wires, *level]), Kind.WALL, m.ZINC, "bend")])


def rail(size: Size) -> Form:
    """A guard rail: a W-beam on posts, its face along +y."""
    length, width, height = size
    x = np.linspace(-length / 2, length / 2, max(int(np.ceil(length / PANEL)), 1) + 1)
    beam = extruded(BEAM + np.array([width / 2, height - BEAM[-1, 1]]), x)
    deep = width + BEAM[:, 0].min()  # what is left for the posts behind it
    posts = _posts(length, deep, height - 0.03, m.ZINC, POSTS, (deep - width) / 2)
    return join([posts, loose(beam, Kind.WALL, m.ZINC, "bend")])


def hedge(size: Size, seed: int) -> Form:
    """A clipped hedge: a dense core of twigs under a skin of leaves."""
    rng = np.random.default_rng(seed)
    length, width, height = size
    skin = min(0.3 * width, 0.3 * length, 0.2)
    core = _block((length - 2 * skin, width - 2 * skin, height - skin), -ROOT, m.LEAF)
    faces = np.array([length * height, length * height, length * width, width * height, width * height])
    n = max(round(LEAFAGE * float(faces.sum())), 12)
    face = rng.choice(5, n, p=faces / faces.sum())
    room = np.maximum(np.array([length, width, height]) - 2 * SIDE / np.sqrt(3), 0.0)
    places = rng.uniform(-0.5, 0.5, (n, 3)) * room
    into = np.minimum(rng.uniform(0, skin, n), 0.4 * room[1])
    for f, (axis, sign) in enumerate(((1, 1), (1, -1), (2, 1), (0, 1), (0, -1))):
        on = face == f
        places[on, axis] = sign * (room[axis] / 2 - into[on])
    places[:, 2] += height / 2
    shades = m.LEAF * rng.uniform(0.85, 1.15, n)
    return join(
        [
            solid(core, Kind.VEGETATION, "bend"),
            loose(leaves(places, SIDE, rng), Kind.VEGETATION, shades, "bend"),
        ]
    )


def _block(size: Size, low: float, reflectivity: float) -> Shell:
    """A cuboid from z = low to the height, in pieces of about PANEL along x."""
    length, width, height = size
    x = np.linspace(-length / 2, length / 2, max(int(np.ceil(length / PANEL)), 1) + 1)
    section = ((-0.5, low), (0.5, low), (0.5, height), (-0.5, height))
    corners = [np.column_stack([x, np.full(len(x), y * width), np.full(len(x), z)]) for y, z in section]
    return loft(np.stack(corners, 1), reflectivity)


def _inside(length: float, every: float) -> F64:
    """Middles (n,) of pieces about `every` apart along a length [m]."""
    n = max(int(length / every), 1)
    return np.asarray(((np.arange(n) + 0.5) / n - 0.5) * length)


def _posts(
    length: float, deep: float, height: float, reflectivity: float, every: float, y: float = 0.0
) -> Form:
    """Square posts about `every` apart, the outer ones at the ends."""
    n = max(round(length / every), 1) + 1
    half = 0.03
    middles = np.linspace(-length / 2 + half, length / 2 - half, n)
    d = deep / 2
    ring = np.array([[-half, y - d], [half, y - d], [half, y + d], [-half, y + d]])
    posts = []
    for x in middles:
        rings = np.stack(
            [np.column_stack([ring + np.array([x, 0.0]), np.full(4, z)]) for z in (-ROOT, height)]
        )
        posts.append(solid(loft(rings, reflectivity), Kind.WALL, "bend"))
    return join(posts)
