"""Trees, conifers, bushes and tall grass. Sizes are length, width and height above the ground [m]."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from datmo.messages import Kind
from sim.scene.scenery import materials as m
from sim.scene.scenery.form import ROOT, Form, join, limb, loose
from sim.scene.scenery.leaves import clumped, in_ball, in_cone, leaves, sprays

Size = tuple[float, float, float]
SPRAY, MOST = 0.28, 1800
"""Side of a tree's sprays of leaves [m], and the most that a tree has."""
TREE_DENSITY, CONIFER_DENSITY, BUSH_DENSITY = 0.7, 1.0, 2.0
"""Leaf area in the crown's volume [m2/m3]."""
BUSH_SPRAY, BUSH_MOST = 0.14, 600
SPARE = 1.5  # so many places a leaf are drawn, and the thickest taken
BLADES, MOST_BLADES = 90.0, 3000  # a square metre of tall grass, and in a patch


def tree(size: Size, seed: int) -> Form:
    """A broad-leaved tree: a trunk that parts into boughs under a crown of clumped leaves."""
    rng = np.random.default_rng(seed)
    length, width, height = size
    base = height * rng.uniform(0.22, 0.31)
    crown = np.array([length, width, height - base]) / 2
    middle = np.array([0.0, 0.0, (height + base) / 2])
    spray = min(SPRAY, 0.5 * float(crown.min()))
    count, side = sprays(TREE_DENSITY * 4 / 3 * np.pi * float(np.prod(crown)), spray, MOST)
    inner = crown - side / np.sqrt(3)
    places = clumped(in_ball(round(SPARE * count), rng) * inner + middle, count, 0.35 * length, rng)
    thick = 0.012 * height + 0.02
    fork = np.array([0.0, 0.0, base + 0.1 * height])
    boughs = [limb(np.array([0.0, 0.0, -ROOT]), fork, (1.15 * thick, 0.8 * thick), 10)]
    count_of_boughs = int(rng.integers(4, 7))
    for i in range(count_of_boughs):
        turn = 2 * np.pi * (i + rng.uniform(-0.3, 0.3)) / count_of_boughs
        way = np.array([np.cos(turn), np.sin(turn), rng.uniform(0.1, 0.9)])
        end = middle + 0.62 * inner * way / np.sqrt(np.sum(way**2))
        boughs.append(limb(fork * np.array([1, 1, 0.94]), end, (0.45 * thick, 0.15 * thick), 5))
    return join([_wood(boughs), _green(places, side, m.LEAF, rng)])


def conifer(size: Size, seed: int) -> Form:
    """A spruce: a straight trunk in a cone of whorls that reaches almost to the ground."""
    rng = np.random.default_rng(seed)
    length, width, height = size
    base = height * rng.uniform(0.06, 0.14)
    volume = np.pi / 12 * length * width * (height - base)
    spray = min(SPRAY, 0.3 * min(length, width))
    count, side = sprays(CONIFER_DENSITY * volume, spray, MOST)
    inset = side / np.sqrt(3)
    stretch = np.array([length / 2 - inset, width / 2 - inset, height - base - 2 * inset])
    points = in_cone(round(SPARE * count), rng)
    whorl = np.cos(2 * np.pi * (points[:, 2] * height + 0.6 * np.hypot(points[:, 0], points[:, 1])) / 1.1)
    thickest = np.argsort(-(whorl + rng.normal(0, 0.8, len(points))), kind="stable")[:count]
    places = points[np.sort(thickest)] * stretch + np.array([0, 0, base + inset])
    thick = 0.011 * height + 0.03
    trunk = limb(np.array([0, 0, -ROOT]), np.array([0, 0, 0.95 * height]), (thick, 0.02), 8)
    return join([_wood([trunk]), _green(places, side, m.NEEDLE, rng)])


def bush(size: Size, seed: int) -> Form:
    """A shrub: leaves from the ground up, on a few stems."""
    rng = np.random.default_rng(seed)
    half = np.array(size) / 2
    spray = min(BUSH_SPRAY, 0.5 * float(half.min()))
    count, side = sprays(BUSH_DENSITY * 4 / 3 * np.pi * float(np.prod(half)), spray, BUSH_MOST)
    inner = np.maximum(half - side / np.sqrt(3), 0)  # leaves are no smaller than they must be
    points = in_ball(round(SPARE * count), rng)
    places = clumped(points * inner + np.array([0, 0, half[2]]), count, 0.5 * size[0], rng)
    stems = []
    for turn in 2 * np.pi * (np.arange(4) + rng.uniform(-0.3, 0.3, 4)) / 4:
        tip = np.array([0.5 * inner[0] * np.cos(turn), 0.5 * inner[1] * np.sin(turn), 1.2 * half[2]])
        stems.append(limb(tip * np.array([0.1, 0.1, 0]) - [0, 0, ROOT], tip, (0.02, 0.008), 4))
    return join([_wood(stems), _green(places, side, m.LEAF, rng)])


def grass(size: Size, seed: int) -> Form:
    """A patch of tall grass: narrow blades, each on its own ground, the tallest in the middle."""
    rng = np.random.default_rng(seed)
    length, width, height = size
    n = min(max(round(BLADES * np.pi / 4 * length * width), 8), MOST_BLADES)
    r, turn, facing = np.sqrt(rng.uniform(0, 1, n)), rng.uniform(0, 2 * np.pi, n), rng.uniform(0, np.pi, n)
    tall = height * rng.uniform(0.55, 1.0, n) * (1 - 0.35 * r**2)
    tall[0] = height
    lean = 0.3 * tall
    room = np.array([length / 2, width / 2])
    foot = np.column_stack([r * np.cos(turn), r * np.sin(turn)]) * np.maximum(room - 0.3 * height - 0.03, 0.0)
    thick = np.column_stack([np.cos(facing), np.sin(facing)]) * rng.uniform(0.012, 0.03, n)[:, None]
    bend = rng.uniform(0, 2 * np.pi, n)
    tip = foot + lean[:, None] * np.column_stack([np.cos(bend), np.sin(bend)])
    low = np.full(n, -0.1)
    corners = [(foot - thick, low), (foot + thick, low), (tip, tall)]
    blades = np.stack([np.column_stack([xy, z]) for xy, z in corners], 1)
    form = loose(blades, Kind.VEGETATION, m.STRAW * rng.uniform(0.85, 1.15, n))
    return Form(form.vertices, np.repeat(foot, 3, 0), form.triangles, form.reflectivity, form.kind)


def _wood(limbs: list[F64]) -> Form:
    return loose(np.concatenate(limbs), Kind.TRUNK, m.BARK)


def _green(places: F64, side: float, reflectivity: float, rng: np.random.Generator) -> Form:
    shades = reflectivity * rng.uniform(0.85, 1.15, len(places))
    return loose(leaves(places, side, rng), Kind.VEGETATION, shades)
