"""All there is to show: every mesh of actors and things, with its kind, size and number of triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, I32, U8
from datmo.messages import Kind
from sim.scene.assets import asset, at_phase, catalogue, describe
from sim.scene.scenery.kinds import SORTS, drawn, form

STEP = 3
"""Phase in which persons are shown walking and running."""
FRONT, BEHIND = 42.0, 142.0
"""Where actors (who look along +x) and things (whose faces are at -x and +y) are seen from [deg]."""
SEEDS = (1, 4)
"""Of the things that are shown, two a kind."""
Size = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Exhibit:
    """One mesh, standing on z = 0 about the origin.

    Attributes:
        name: key of an asset, or kind of a thing. words: what it is. kind: of most of it. size: [m].
        vertices: (v, 3) [m]. triangles: (t, 3). triangle_kind: (t,). reflectivity: (t,).
        azimuth_deg: whence it is looked at.
    """

    name: str
    words: str
    kind: Kind
    size: Size
    vertices: F32
    triangles: I32
    triangle_kind: U8
    reflectivity: F32
    azimuth_deg: float = FRONT


def vehicles() -> list[Exhibit]:
    """Every mesh of a vehicle."""
    return [_actor(key) for key in catalogue() if asset(key).kind != Kind.PEDESTRIAN]


def persons() -> list[Exhibit]:
    """Every person, standing, walking and running."""
    still = [key for key in catalogue() if asset(key).kind == Kind.PEDESTRIAN]
    return [
        _actor(form)
        for key in still
        for form in (key, *(at_phase(key, STEP, gait) for gait in ("walk", "run")))
    ]


def things() -> list[Exhibit]:
    """Two shapes of every kind of thing."""
    return [_thing(kind, seed) for kind in SORTS for seed in SEEDS]


def _actor(key: str) -> Exhibit:
    a = asset(key)
    kind = np.full(len(a.triangles), a.kind, np.uint8)
    words = describe(key).rsplit(", ", 1)[0]
    return Exhibit(key, words, a.kind, a.size, a.vertices, a.triangles, kind, a.reflectivity)


def _thing(kind: str, seed: int) -> Exhibit:
    size = drawn(kind, seed)
    made = form(kind, size, seed)
    return Exhibit(
        kind,
        f"seed {seed}",
        SORTS[kind].kind,
        size,
        made.vertices.astype(np.float32),
        made.triangles.astype(np.int32),
        made.kind,
        made.reflectivity.astype(np.float32),
        BEHIND,
    )
