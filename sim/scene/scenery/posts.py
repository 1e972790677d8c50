"""What stands on one foot: poles, street lamps, signs, traffic lights, bollards, bins, containers."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from datmo.messages import Kind
from sim.scene.bodies.primitives import box, loft
from sim.scene.scenery import materials as m
from sim.scene.scenery.form import ROOT, Form, join, loose, solid

Size = tuple[float, float, float]


def pole(size: Size) -> Form:
    """An elliptic cylinder, length x width across."""
    return solid(loft(_round(size[0], size[1], (-ROOT, size[2])), m.STEEL), Kind.POLE)


def lamp(size: Size) -> Form:
    """A tapered column with an arm along +y, `width` long, and a flat lantern at its end."""
    length, arm, height = size
    column = loft(_round(0.8 * length, 0.8 * length, (-ROOT, height - 0.12), taper=0.55), m.ZINC)
    beam = box((0, arm / 2 - 0.2, height - 0.1), (0.07, arm - 0.4, 0.07), m.ZINC)
    lantern = box((0, arm - 0.35, height - 0.08), (length, 0.7, 0.16), m.ZINC)
    return join([solid(part, Kind.POLE) for part in (column, beam, lantern)])


def sign(size: Size, seed: int) -> Form:
    """A round, triangular, square or eight-sided plate of retro-reflecting sheeting on a tube; faces -x."""
    _, width, height = size
    corners, first = ((24, 0.0), (3, np.pi / 2), (4, np.pi / 4), (8, np.pi / 8))[seed % 4]
    turn = first + 2 * np.pi * np.arange(corners) / corners
    outline = np.column_stack([np.cos(turn), np.sin(turn)])
    outline *= width / np.ptp(outline[:, 0])
    outline[:, 1] += height - outline[:, 1].max()
    rings = np.stack([np.column_stack([np.full(corners, x), outline]) for x in (-0.045, -0.035)])
    plate = loft(rings, m.ZINC)
    facing = plate.vertices[plate.triangles][..., 0].max(1) < -0.04
    shades = np.where(facing, m.SHEETING, plate.reflectivity)
    form = solid(plate, Kind.SIGN)
    post = solid(loft(_round(0.06, 0.06, (-ROOT, height - 0.1)), m.ZINC), Kind.POLE)
    return join([Form(form.vertices, form.foot, form.triangles, shades, form.kind), post])


def traffic_light(size: Size) -> Form:
    """A mast with a head of three hooded lenses that faces -x."""
    _, width, height = size
    mast = solid(loft(_round(0.11, 0.11, (-ROOT, height)), m.STEEL), Kind.POLE)
    middle = height - 0.5
    head = solid(box((-0.2, 0, middle), (0.2, width, 0.9), m.BLACK), Kind.THING)
    hoods = [
        solid(box((-0.3 - 0.05, 0, middle + z + 0.1), (0.12, 0.6 * width, 0.02), m.BLACK), Kind.THING)
        for z in (-0.3, 0.0, 0.3)
    ]
    return join([mast, head, *hoods])


def bollard(size: Size) -> Form:
    """A short round post with a cap."""
    length, width, height = size
    shaft = loft(_round(0.85 * length, 0.85 * width, (-ROOT, height - 0.12)), m.STEEL)
    cap = loft(_round(length, width, (height - 0.12, height), taper=0.8), m.STEEL)
    return join([solid(shaft, Kind.POLE), solid(cap, Kind.POLE)])


def waste_bin(size: Size) -> Form:
    """A two-wheeled bin: a body that widens upwards, a lid that slopes to the front (+y), wheels behind."""
    length, width, height = size
    body = loft(_tub(size, 0.2 * height / 2, 0.93 * height, 0.78), m.PLASTIC)
    lid = _wedge((length, width), (0.93 * height, 0.97 * height), height)
    tyre = box((0, 0.09 - width / 2, 0.05), (0.9 * length, 0.18, 0.3), m.BLACK)
    foot = box((0, 0.2 * width, 0.02), (0.7 * length, 0.25 * width, 0.24), m.PLASTIC)
    return join([solid(body, Kind.THING), lid, solid(tyre, Kind.THING), solid(foot, Kind.THING)])


def container(size: Size, seed: int) -> Form:
    """A four-wheeled waste container with a sloping lid and trunnions at its sides."""
    length, width, height = size
    body = loft(
        _tub((0.92 * length, width, height), 0.2, 0.82 * height, 0.86), m.ZINC if seed % 2 else m.PLASTIC
    )
    lid = _wedge((0.94 * length, width), (0.82 * height, 0.88 * height), height)
    pins = box((0, 0, 0.75 * height), (length, 0.08, 0.08), m.ZINC)
    wheels = [
        box((x * 0.36 * length, y * 0.32 * width, 0.08), (0.06, 0.2, 0.26), m.BLACK)
        for x in (-1, 1)
        for y in (-1, 1)
    ]
    return join([solid(body, Kind.THING), lid, *(solid(part, Kind.THING) for part in (pins, *wheels))])


def _round(length: float, width: float, levels: tuple[float, float], taper: float = 1.0) -> F64:
    """Two elliptic rings (2, 12, 3), the upper one `taper` times as wide."""
    turn = 2 * np.pi * np.arange(12) / 12
    ring = np.column_stack([length / 2 * np.cos(turn), width / 2 * np.sin(turn)])
    scales = (1.0, taper)
    return np.stack(
        [np.column_stack([s * ring, np.full(12, z)]) for s, z in zip(scales, levels, strict=True)]
    )


def _tub(size: Size, low: float, high: float, narrow: float) -> F64:
    """Two rectangles (2, 4, 3); the lower one `narrow` times as wide."""
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * np.array(size[:2])
    return np.stack([np.column_stack([s * square, np.full(4, z)]) for s, z in ((narrow, low), (1.0, high))])


def _wedge(plan: tuple[float, float], front: tuple[float, float], back: float) -> Form:
    """A lid (length, width) from z front[0] up, front[1] high at +y and `back` high at -y."""
    x, y = plan[0] / 2, plan[1] / 2
    top = np.array([[-x, -y, back], [x, -y, back], [x, y, front[1]], [-x, y, front[1]]])
    low = top.copy()
    low[:, 2] = front[0]
    sides = np.stack([low, np.roll(low, -1, 0), np.roll(top, -1, 0), top], 1)
    return loose(np.concatenate([sides, top[None]]), Kind.THING, m.PLASTIC)
