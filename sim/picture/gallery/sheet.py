"""Contact sheets: every vehicle, person, thing and ground, each mesh with what an HDL-64E returns of it."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from datmo.arrays import F64, U8
from sim.picture.gallery.cloud import cloud, distance
from sim.picture.gallery.exhibits import Exhibit, persons, things, vehicles
from sim.picture.gallery.scenes import pictures, presets
from sim.picture.gallery.view import camera, colours, mesh_view, splat
from sim.picture.grounds import ground, ground_names
from sim.picture.terrain import terrain_view

TILE = 150, 200
"""Height and width of a picture [pixels]; an exhibit has two, the mesh and its cloud."""
NIGHT, FLOOR_DOT = (22, 25, 31), (74, 80, 92)
INK, FAINT, PAPER, EDGE, TEXT = (30, 34, 42), (104, 112, 124), (255, 255, 255), 8, 30
ASIDE = 15.0  # the sensor stands so far to the right of the camera [deg]
ACROSS = 3  # exhibits side by side
GROUNDS_ACROSS = 4
LARGEST = 590_000  # bytes of a file
Cell = tuple[str, str, U8]


def sheets() -> Iterator[tuple[str, bytes]]:
    """The contact sheets as PNG files, one by one with their names."""
    for name, (cells, across) in SHEETS.items():
        yield name, encoded(sheet(cells(), across))


def sheet(cells: Sequence[Cell], across: int) -> Image.Image:
    """Pictures of one size (h, w, 3) in rows, with a title and a line of small print below each."""
    h, w = cells[0][2].shape[:2]
    rows = -(-len(cells) // across)
    page = Image.new("RGB", (across * (w + EDGE) + EDGE, rows * (h + TEXT + EDGE) + EDGE), PAPER)
    draw = ImageDraw.Draw(page)
    bold, small = ImageFont.load_default(13), ImageFont.load_default(11)
    for i, (title, note, picture) in enumerate(cells):
        x, y = EDGE + (i % across) * (w + EDGE), EDGE + (i // across) * (h + TEXT + EDGE)
        page.paste(Image.fromarray(picture), (x, y))
        draw.text((x + 2, y + h + 2), title, INK, bold)
        draw.text((x + 2, y + h + 16), note, FAINT, small)
    return page


def encoded(page: Image.Image, largest: int = LARGEST) -> bytes:
    """A PNG of at most `largest` bytes, with as many colours as that allows."""
    data = b""
    for count in (160, 96, 64, 40, 24, 12):
        file = io.BytesIO()
        page.quantize(count, dither=Image.Dither.NONE).save(file, "PNG", optimize=True)
        data = file.getvalue()
        if len(data) <= largest:
            break
    return data


def exhibit(one: Exhibit) -> Cell:
    """Title, small print, and the mesh beside its cloud (h, 2 w, 3)."""
    colour = colours(one.triangle_kind, one.reflectivity)
    used = one.vertices[one.triangles].reshape(-1, 3).astype(float)
    low, high = used.min(0), used.max(0)
    low[2] = 0.0
    view = camera(low, high, TILE, one.azimuth_deg)
    points, which = cloud(one.vertices, one.triangles, one.azimuth_deg + ASIDE)
    dots: F64 = np.where(which[:, None] >= 0, 1.25 * colour[which], FLOOR_DOT)
    night = splat(view, points, dots, NIGHT)
    picture = np.concatenate([mesh_view(one.vertices, one.triangles, colour, view), night], 1)
    returns = int(np.count_nonzero(which >= 0))
    size = " x ".join(f"{s:.2f}" for s in one.size)
    note = f"{size} m, {len(one.triangles)} triangles, {returns} returns at {distance(float(high[2])):g} m"
    return f"{one.name}  {one.words}", note, picture


def _vehicles() -> list[Cell]:
    return [exhibit(one) for one in vehicles()]


def _persons() -> list[Cell]:
    return [exhibit(one) for one in persons()]


def _things() -> list[Cell]:
    return [exhibit(one) for one in things()]


def _scenery() -> list[Cell]:
    shown = [(name, pictures(name)) for name in presets()]
    return [cell for name, (seen, swept) in shown for cell in ((name, "", seen), ("", "one sweep", swept))]


def _grounds() -> list[Cell]:
    return [(name, "", terrain_view(ground(name), 300)) for name in ground_names()]


SHEETS: dict[str, tuple[Callable[[], list[Cell]], int]] = {
    "vehicles": (_vehicles, ACROSS),
    "persons": (_persons, ACROSS),
    "things": (_things, ACROSS),
    "scenery": (_scenery, 2),
    "grounds": (_grounds, GROUNDS_ACROSS),
}
"""How each sheet is drawn, and how many pictures lie side by side."""
