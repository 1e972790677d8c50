"""Anti-aliased strokes, dots and digits on an RGB image, quick enough for every step."""

from __future__ import annotations

import math

import numba
import numpy as np

from datmo.arrays import F64, U8, Array

BACKGROUND = (15, 17, 21)
GLYPHS: U8 = np.array(
    [
        [0b111, 0b101, 0b101, 0b101, 0b111],
        [0b010, 0b110, 0b010, 0b010, 0b111],
        [0b111, 0b001, 0b111, 0b100, 0b111],
        [0b111, 0b001, 0b011, 0b001, 0b111],
        [0b101, 0b101, 0b111, 0b001, 0b001],
        [0b111, 0b100, 0b111, 0b001, 0b111],
        [0b111, 0b100, 0b111, 0b101, 0b111],
        [0b111, 0b001, 0b010, 0b010, 0b010],
        [0b111, 0b101, 0b111, 0b101, 0b111],
        [0b111, 0b101, 0b111, 0b001, 0b111],
    ],
    np.uint8,
)
"""Digits 0-9, five rows of three bits."""


@numba.njit(cache=True, nogil=True)
def _dots(image: U8, at: F64, colours: U8, size: int) -> None:
    for i in range(len(at)):
        if not (math.isfinite(at[i, 0]) and math.isfinite(at[i, 1])):
            continue
        row, column = math.floor(at[i, 0]), math.floor(at[i, 1])
        for r in range(max(row, 0), min(row + size, image.shape[0])):
            for c in range(max(column, 0), min(column + size, image.shape[1])):
                for k in range(3):
                    image[r, c, k] = colours[i, k]


@numba.njit(cache=True, nogil=True)
def _strokes(image: U8, ends: F64, colours: U8, width: float, alpha: float) -> None:
    """Segments (m, 4) row, column, row, column; coverage falls off over one pixel at the rim."""
    pad = width / 2 + 1
    for i in range(len(ends)):
        ar, ac, br, bc = ends[i]
        dr, dc = br - ar, bc - ac
        length2 = dr * dr + dc * dc
        top, bottom = max(0.0, min(ar, br) - pad), min(image.shape[0] - 1.0, max(ar, br) + pad)
        left, right = max(0.0, min(ac, bc) - pad), min(image.shape[1] - 1.0, max(ac, bc) + pad)
        for r in range(math.ceil(top), math.floor(bottom) + 1):
            for c in range(math.ceil(left), math.floor(right) + 1):
                s = ((r - ar) * dr + (c - ac) * dc) / length2 if length2 > 0 else 0.0
                s = min(max(s, 0.0), 1.0)
                distance = math.hypot(r - ar - s * dr, c - ac - s * dc)
                cover = alpha * min(max(width / 2 + 0.5 - distance, 0.0), 1.0)
                if cover > 0:
                    for k in range(3):
                        image[r, c, k] = np.uint8(image[r, c, k] * (1 - cover) + colours[i, k] * cover + 0.5)


class Raster:
    """A square picture of a plane seen from above, x up and y to the left.

    Args:
        pixels: side of the picture.
        radius: half its extent [m].
    """

    def __init__(self, pixels: int, radius: float) -> None:
        self.image: U8 = np.full((pixels, pixels, 3), BACKGROUND, np.uint8)
        self.radius = radius
        self.scale = pixels / (2 * radius)

    def pixel(self, xy: Array) -> F64:
        """Row and column (n, 2) of places (n, 2) [m]."""
        return np.asarray((self.radius - np.asarray(xy, float)) * self.scale)

    def dots(self, xy: Array, colours: U8, size: int = 1) -> None:
        """Squares of `size` pixels in `colours` (n, 3); later ones lie on top."""
        _dots(self.image, self.pixel(xy), colours, size)

    def segments(
        self, a: Array, b: Array, colour: tuple[int, ...] | U8, width: float = 1.0, alpha: float = 1.0
    ) -> None:
        """Segments from places `a` to places `b` (m, 2) [m], in one colour or one each (m, 3)."""
        ends = np.hstack([self.pixel(a), self.pixel(b)])
        finite = np.isfinite(ends).all(1)
        near = (np.abs(ends) < 1e5).all(1)
        colours = np.broadcast_to(np.asarray(colour, np.uint8), (len(ends), 3))
        _strokes(self.image, ends[finite & near], colours[finite & near].copy(), width, alpha)

    def line(
        self,
        xy: Array,
        colour: tuple[int, ...] | U8,
        width: float = 1.0,
        alpha: float = 1.0,
        closed: bool = False,
    ) -> None:
        """A polyline through places (m, 2) [m]."""
        xy = np.asarray(xy, float)
        tail = np.roll(xy, -1, axis=0) if closed else xy[1:]
        self.segments(xy if closed else xy[:-1], tail, colour, width, alpha)

    def dashes(self, xy: Array, colour: tuple[int, ...] | U8, width: float = 1.0, dash: float = 0.6) -> None:
        """A closed dashed line through places (m, 2), dashes and gaps of `dash` [m]."""
        for a, b in zip(np.asarray(xy, float), np.roll(xy, -1, axis=0), strict=True):
            length = float(np.hypot(*(b - a)))
            if not 0 < length < 200:
                continue
            start = np.arange(0, length, 2 * dash)[:, None]
            along = (b - a) / length
            self.segments(a + start * along, a + np.minimum(start + dash, length) * along, colour, width)

    def number(self, xy: Array, value: int, colour: tuple[int, ...] | U8, size: int = 2) -> None:
        """A number centred on a place (2,), on a dark ground so that it can be read anywhere."""
        digits = [GLYPHS[int(d)] for d in str(abs(value))]
        bits = np.zeros((7, 4 * len(digits) + 1), bool)
        for k, glyph in enumerate(digits):
            bits[1:6, 4 * k + 1 : 4 * k + 4] = (glyph[:, None] >> np.array([2, 1, 0])) & 1
        mask = np.kron(bits, np.ones((size, size), bool))
        row, column = self.pixel(np.asarray(xy)[None])[0]
        if not (np.isfinite(row) and np.isfinite(column)):
            return
        top, left = int(row) - mask.shape[0] // 2, int(column) - mask.shape[1] // 2
        side = self.image.shape[0]
        if top < 0 or left < 0 or top + mask.shape[0] > side or left + mask.shape[1] > side:
            return
        patch = self.image[top : top + mask.shape[0], left : left + mask.shape[1]]
        patch[...] = np.where(mask[..., None], np.asarray(colour, np.uint8), patch // 4)
