"""Every kind of thing: how it is made, and within which sizes, with their source."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from datmo.errors import SimulationError, nearest
from datmo.messages import Kind
from sim.scene.scenery import barriers, buildings, plants, posts
from sim.scene.scenery.form import Form

Size = tuple[float, float, float]
CENTIMETRE = 2  # decimals to which a drawn size is rounded
TREES = "Urban Tree Database (McPherson, van Doorn, Peper 2016), street trees of 15-30 years"


@dataclass(frozen=True)
class Sort:
    """A kind of thing.

    Args:
        make: its form by size and seed. kind: of most of its triangles.
        least, most: length, width, height that a size is drawn from [m]. source: of these.
        foot: share of length and width that meets the ground, such as a tree's trunk.
        line: whether pieces of it set end to end make a line.
    """

    make: Callable[[Size, int], Form]
    kind: Kind
    least: Size
    most: Size
    source: str
    foot: float = 1.0
    line: bool = False


def _plain(make: Callable[[Size], Form]) -> Callable[[Size, int], Form]:
    """What has one shape, whatever the seed."""
    return lambda size, _seed: make(size)


POSTS = {
    "pole": Sort(
        _plain(posts.pole), Kind.POLE, (0.12, 0.12, 3.5), (0.25, 0.25, 8.0), "EN 40-2: columns from 3 m on"
    ),
    "lamp": Sort(
        _plain(posts.lamp),
        Kind.POLE,
        (0.22, 1.2, 8.0),
        (0.28, 2.2, 10.0),
        "Global Street Design Guide (NACTO 2016): 8-10 m in streets",
        0.1,
    ),
    "sign": Sort(
        posts.sign,
        Kind.SIGN,
        (0.09, 0.6, 2.6),
        (0.09, 0.9, 3.2),
        "VwV-StVO: plates of 600 to 900 mm, their lower edge 2.0 m or more above the ground",
    ),
    "traffic_light": Sort(
        _plain(posts.traffic_light),
        Kind.THING,
        (0.82, 0.3, 3.2),
        (0.82, 0.35, 3.5),
        "EN 12368: lenses of 200 mm; RiLSA 2015: 2.1 m or more clear below",
    ),
    "bollard": Sort(
        _plain(posts.bollard),
        Kind.POLE,
        (0.1, 0.1, 0.8),
        (0.2, 0.2, 1.1),
        "arrêté of 15 January 2007 (France): from 0.06 m across at 1.1 m to 0.21 m at 0.6 m",
    ),
    "bin": Sort(
        _plain(posts.waste_bin),
        Kind.THING,
        (0.48, 0.55, 0.93),
        (0.58, 0.74, 1.1),
        "EN 840-1: two wheels, 120 to 240 l",
    ),
    "container": Sort(
        posts.container,
        Kind.THING,
        (1.26, 0.8, 1.2),
        (1.37, 1.11, 1.47),
        "EN 840-2: four wheels, 660 to 1100 l",
    ),
}
LINES = {
    "wall": Sort(
        _plain(barriers.wall),
        Kind.WALL,
        (4.0, 0.24, 1.2),
        (10.0, 0.365, 2.2),
        "DIN 4172: thick in steps of 125 mm less a joint",
        line=True,
    ),
    "fence": Sort(
        barriers.fence,
        Kind.WALL,
        (5.0, 0.06, 0.83),
        (12.5, 0.06, 2.03),
        "double-bar mats: panels of 2.51 m, 0.83 to 2.43 m high",
        line=True,
    ),
    "rail": Sort(
        _plain(barriers.rail),
        Kind.WALL,
        (8.0, 0.19, 0.7),
        (16.0, 0.23, 0.8),
        "AASHTO M 180 W-beam; its upper edge at 0.75 m (RPS 2009)",
        line=True,
    ),
    "hedge": Sort(
        barriers.hedge,
        Kind.VEGETATION,
        (3.0, 0.6, 1.2),
        (8.0, 1.0, 2.0),
        "garden hedges up to 2 m (AGBGB Bavaria, art. 47)",
        line=True,
    ),
}
LARGE = {
    "building": Sort(
        buildings.building,
        Kind.BUILDING,
        (11.0, 8.0, 6.5),
        (17.0, 12.0, 15.0),
        "TABULA building typology (IWU 2012): houses of 2 to 5 storeys",
    ),
    "tree": Sort(plants.tree, Kind.VEGETATION, (4.5, 4.5, 7.0), (7.5, 7.5, 11.5), TREES, 0.1),
    "conifer": Sort(plants.conifer, Kind.VEGETATION, (3.4, 3.4, 8.0), (5.5, 5.5, 15.0), TREES, 0.2),
    "bush": Sort(
        plants.bush,
        Kind.VEGETATION,
        (1.0, 1.0, 0.8),
        (2.2, 2.2, 1.8),
        "shrubs up to 2 m: nanophanerophytes (Raunkiær 1934)",
        0.8,
    ),
    "grass": Sort(
        plants.grass,
        Kind.VEGETATION,
        (1.2, 1.2, 0.3),
        (3.0, 3.0, 0.8),
        "grasses of hay meadows, such as Dactylis and Festuca (Rothmaler 2017)",
    ),
}
SORTS: dict[str, Sort] = {**POSTS, **LINES, **LARGE}


def sort(kind: str) -> Sort:
    """What is known of a kind.

    Raises:
        SimulationError: there is no such kind; the nearest are named.
    """
    if kind not in SORTS:
        raise SimulationError(f"there is no thing of kind {kind!r}; {nearest(kind, SORTS)}")
    return SORTS[kind]


@lru_cache(maxsize=512)
def drawn(kind: str, seed: int) -> Size:
    """A size within the limits of a kind [m]: length and width by one draw, height by another."""
    limits, rng = sort(kind), np.random.default_rng([seed, 1])
    plan, rise = (float(share) for share in rng.uniform(0, 1, 2))
    shares = (plan, plan, rise)
    sizes = [
        round(a + s * (b - a), CENTIMETRE) for a, b, s in zip(limits.least, limits.most, shares, strict=True)
    ]
    return sizes[0], sizes[1], sizes[2]


@lru_cache(maxsize=512)
def form(kind: str, size: Size, seed: int) -> Form:
    """The shape of a thing in its own axes, made once; its arrays are shared."""
    made = sort(kind).make(size, seed)
    for array in (made.vertices, made.foot, made.triangles, made.reflectivity, made.kind):
        array.flags.writeable = False
    return made
