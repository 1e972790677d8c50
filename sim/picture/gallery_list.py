"""The catalogue in words: every vehicle, person, thing and ground with its kind, size and triangles."""

from __future__ import annotations

from dataclasses import dataclass

from sim.picture.gallery_exhibits import Exhibit, persons, vehicles
from sim.picture.grounds import ground_names
from sim.scene.scenery.kinds import SORTS, drawn, form

SHAPES = range(8)
"""Seeds of the shapes whose triangles are counted."""


@dataclass(frozen=True)
class Row:
    """One line of the catalogue, ready to print; `note` tells the source of a thing's size."""

    name: str
    kind: str
    size: str
    triangles: str
    note: str = ""


def catalogue() -> dict[str, list[Row]]:
    """Rows by group: vehicles, persons, things, grounds."""
    return {
        "vehicles": [_row(one) for one in vehicles()],
        "persons": [_row(one) for one in persons()],
        "things": [_thing(kind) for kind in SORTS],
        "grounds": [Row(name, "FIELD, ROAD", "80 × 80", "") for name in ground_names()],
    }


def _row(one: Exhibit) -> Row:
    size = " × ".join(f"{s:.2f}" for s in one.size)
    return Row(one.name, one.kind.name, size, str(len(one.triangles)))


def _thing(kind: str) -> Row:
    known = SORTS[kind]
    size = " × ".join(_span(a, b, "g") for a, b in zip(known.least, known.most, strict=True))
    counts = [len(form(kind, drawn(kind, seed), seed).triangles) for seed in SHAPES]
    return Row(kind, known.kind.name, size, _span(min(counts), max(counts), "d"), known.source)


def _span(low: float, high: float, how: str) -> str:
    return format(low, how) if low == high else f"{low:{how}}-{high:{how}}"
