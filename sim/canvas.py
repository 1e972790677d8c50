"""A small software canvas: points, lines and digits on an RGB image, quick enough for every step."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, U8, Array

Colour = tuple[int, int, int]
BACKGROUND: Colour = (16, 18, 22)
GRID: Colour = (44, 48, 56)
_DIGITS = (
    "111101101101111 010110010010111 111001111100111 111001111001111 101101111001001 "
    "111100111001111 111100111101111 111001010010010 111101111101111 111101111001111"
)
GLYPHS = [np.array([int(c) for c in glyph]).reshape(5, 3) for glyph in _DIGITS.split()]


class Canvas:
    """A square picture of the ground plane seen from above, forward up.

    Args:
        pixels: side of the picture.
        radius: half its extent [m].
    """

    def __init__(self, pixels: int = 800, radius: float = 50.0) -> None:
        self.image: U8 = np.full((pixels, pixels, 3), BACKGROUND, np.uint8)
        self._pixels, self._radius = pixels, radius

    def pixel(self, xy: Array) -> tuple[Array, Array]:
        """Row and column (float) of places (n, 2) [m, x forward, y left of the middle]."""
        scale = self._pixels / (2 * self._radius)
        return (self._radius - xy[:, 0]) * scale, (self._radius - xy[:, 1]) * scale

    def points(self, xy: Array, colours: Array, size: int = 1) -> None:
        """Dots of `size` pixels in `colours` (n, 3) or one colour; later ones lie on top."""
        row, column = (np.floor(v).astype(np.int64) for v in self.pixel(xy))
        colours = np.broadcast_to(np.asarray(colours, np.uint8), (len(row), 3))
        for dr in range(size):
            for dc in range(size):
                r, c = row + dr, column + dc
                inside = (r >= 0) & (r < self._pixels) & (c >= 0) & (c < self._pixels)
                self.image[r[inside], c[inside]] = colours[inside]

    def line(self, xy: F64, colour: Array | Colour, closed: bool = False, size: int = 1) -> None:
        """A polyline through places (m, 2)."""
        xy = np.asarray(xy, float)
        if closed:
            xy = np.vstack([xy, xy[:1]])
        if len(xy) < 2 or not np.isfinite(xy).all():
            return
        step = self._radius / self._pixels
        spans = np.linalg.norm(np.diff(xy, axis=0), axis=1)
        counts = np.minimum(np.ceil(spans / step).astype(int) + 1, 4 * self._pixels)
        dots = [
            a + (b - a) * np.linspace(0, 1, n)[:, None]
            for a, b, n in zip(xy[:-1], xy[1:], counts, strict=True)
        ]
        self.points(np.vstack(dots), np.asarray(colour), size)

    def rings(self, every: float = 10.0) -> None:
        """Range rings about the sensor."""
        angle = np.linspace(0, 2 * np.pi, 720)
        for radius in np.arange(every, self._radius + every / 2, every):
            self.points(radius * np.stack([np.cos(angle), np.sin(angle)], -1), GRID)

    def number(self, xy: Array, value: int, colour: Array | Colour, size: int = 2) -> None:
        """A number with its left lower corner at a place (2,)."""
        row, column = (int(v[0]) for v in self.pixel(np.asarray(xy, float)[None]))
        for k, digit in enumerate(str(abs(int(value)))):
            glyph = np.kron(GLYPHS[int(digit)], np.ones((size, size), int))
            r, c = np.nonzero(glyph)
            r, c = r + row - glyph.shape[0], c + column + k * 4 * size
            inside = (r >= 0) & (r < self._pixels) & (c >= 0) & (c < self._pixels)
            self.image[r[inside], c[inside]] = np.asarray(colour, np.uint8)
