"""All there is to show: every mesh of actors and things, with its kind, size and number of triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, I32, U8
from datmo.errors import SimulationError
from datmo.messages import Kind
from sim.scene.assets import asset, keys
from sim.scene.scenery.kinds import SORTS, drawn, form

PERSONS = (Kind.PEDESTRIAN,)
VEHICLES = (Kind.CAR, Kind.VAN, Kind.TRUCK, Kind.BUS, Kind.MOTORCYCLE, Kind.BICYCLE)
FRONT, BEHIND = 42.0, 142.0
"""Where actors (who look along +x) and things (whose faces are at -x and +y) are seen from [deg]."""
SEEDS = (1, 4)
"""Of the things that are shown, two a kind."""
Size = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Exhibit:
    """One mesh, standing on z = 0 about the origin.

    Attributes:
        name: key of an asset, or kind and seed of a thing. kind: of most of it. size: [m].
        vertices: (v, 3) [m]. triangles: (t, 3). triangle_kind: (t,). reflectivity: (t,).
        azimuth_deg: whence it is looked at.
    """

    name: str
    kind: Kind
    size: Size
    vertices: F32
    triangles: I32
    triangle_kind: U8
    reflectivity: F32
    azimuth_deg: float = FRONT


def vehicles() -> list[Exhibit]:
    """Every mesh of a vehicle."""
    return [_actor(key) for kind in VEHICLES for key in _keys(kind)]


def persons() -> list[Exhibit]:
    """Every person, standing, and walking."""
    return [_actor(name) for kind in PERSONS for key in _keys(kind) for name in (key, f"{key}/3")]


def things() -> list[Exhibit]:
    """Two shapes of every kind of thing."""
    return [_thing(kind, seed) for kind in SORTS for seed in SEEDS]


def _keys(kind: Kind) -> tuple[str, ...]:
    try:
        return keys(kind)
    except SimulationError:
        return ()


def _actor(key: str) -> Exhibit:
    a = asset(key)
    kind = np.full(len(a.triangles), a.kind, np.uint8)
    return Exhibit(key, a.kind, a.size, a.vertices, a.triangles, kind, a.reflectivity)


def _thing(kind: str, seed: int) -> Exhibit:
    size = drawn(kind, seed)
    made = form(kind, size, seed)
    return Exhibit(
        f"{kind}, seed {seed}",
        SORTS[kind].kind,
        size,
        made.vertices.astype(np.float32),
        made.triangles.astype(np.int32),
        made.kind,
        made.reflectivity.astype(np.float32),
        BEHIND,
    )
