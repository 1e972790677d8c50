"""The catalogue in words: every vehicle, person, thing and ground with its kind, size and triangles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from datmo.messages import Kind
from sim.picture.gallery.exhibits import Exhibit, persons, vehicles
from sim.picture.grounds import ground, ground_names
from sim.scene.scenery.kinds import SORTS, drawn, form

SHAPES = range(8)
"""Seeds of the shapes whose triangles are counted."""


@dataclass(frozen=True)
class Row:
    """One line of the catalogue, ready to print; `note` tells what it is, or the source of a thing's size."""

    name: str
    kind: str
    size: str
    triangles: str
    note: str


@cache
def catalogue() -> dict[str, list[Row]]:
    """Rows by group, as the sheets are named; the presets of scenery have none."""
    return {
        "vehicles": [_row(one) for one in vehicles()],
        "persons": [_row(one) for one in persons() if one.name.count("/") == 1],
        "things": [_thing(kind) for kind in SORTS],
        "scenery": [],
        "grounds": [_ground(name) for name in ground_names()],
    }


def _row(one: Exhibit) -> Row:
    size = " × ".join(f"{s:.2f}" for s in one.size)
    return Row(one.name, one.kind.name, size, str(len(one.triangles)), one.words)


def _ground(name: str) -> Row:
    made = ground(name)
    x0, y0, x1, y1 = made.area
    kinds = ", ".join(Kind(kind).name for kind in np.unique(made.kind))
    note = f"field {made.roughness}, road {made.road_roughness}"
    size = f"{x1 - x0:g} × {y1 - y0:g} × {np.ptp(made.height):.2f}"
    return Row(name, kinds, size, str(2 * len(made.mesh_kind)), note)


def _thing(kind: str) -> Row:
    known = SORTS[kind]
    size = " × ".join(_span(a, b, "g") for a, b in zip(known.least, known.most, strict=True))
    counts = [len(form(kind, drawn(kind, seed), seed).triangles) for seed in SHAPES]
    return Row(kind, known.kind.name, size, _span(min(counts), max(counts), "d"), known.source)


def _span(low: float, high: float, how: str) -> str:
    return format(low, how) if low == high else f"{low:{how}}-{high:{how}}"
