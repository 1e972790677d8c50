"""The picture of a ground: shaded relief in the colours of its kinds, from above or from a height."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, U8
from datmo.messages import Kind
from sim.scene.terrain import Terrain

PIXELS = 900
COLOURS = {Kind.ROAD: (120, 122, 128), Kind.SIDEWALK: (190, 178, 160), Kind.FIELD: (124, 142, 92)}
LIGHT = np.array([-0.55, 0.45, 0.70])
"""Towards the sun, from the upper left; maps are lit so, or hills look like hollows."""
AMBIENT = 0.3


def terrain_picture(terrain: Terrain, pixels: int = PIXELS, exaggerate: float | None = None) -> U8:
    """The ground from above (h, w, 3), +y up, the longer side `pixels` long.

    Args:
        exaggerate: factor on the heights that the light sees; null: so that the steep parts show.
    """
    xy, shape = _places(terrain, pixels)
    height = terrain.height_at(xy).reshape(shape)
    normal = terrain.normal_at(xy)
    slope = -(normal[:, :2] / normal[:, 2:]).reshape(*shape, 2)
    if exaggerate is None:
        steep = float(np.quantile(np.hypot(slope[..., 0], slope[..., 1]), 0.98))
        exaggerate = float(np.clip(0.5 / max(steep, 1e-6), 1.0, 20.0))
    return _paint(_lit(slope * exaggerate), terrain.kind_at(xy).reshape(shape), height)


def _places(terrain: Terrain, pixels: int) -> tuple[F64, tuple[int, int]]:
    """World places (h w, 2) of the pixels' middles, row by row from the highest y, and (h, w)."""
    x0, y0, x1, y1 = terrain.area
    metres = max(x1 - x0, y1 - y0) / pixels
    w, h = (max(round(side / metres), 1) for side in (x1 - x0, y1 - y0))
    x = x0 + (np.arange(w) + 0.5) * (x1 - x0) / w
    y = y1 - (np.arange(h) + 0.5) * (y1 - y0) / h
    return np.column_stack([np.tile(x, h), np.repeat(y, w)]), (h, w)


def _lit(slope: F64) -> F64:
    """Brightness of slopes (..., 2) under the light, Lambert's cosine, level ground at about 0.8."""
    light = LIGHT / np.sqrt(np.sum(LIGHT**2))
    cosine = (light[2] - slope[..., 0] * light[0] - slope[..., 1] * light[1]) / np.sqrt(
        1 + np.sum(slope**2, axis=-1)
    )
    return np.asarray(AMBIENT + (1 - AMBIENT) * np.maximum(cosine, 0.0))


def _paint(bright: F64, kind: U8, height: F64) -> U8:
    table = np.full((256, 3), 128.0)
    for code, colour in COLOURS.items():
        table[code] = colour
    low, high = float(height.min()), float(height.max())
    share = (height - low) / max(high - low, 1e-9)
    tint = 0.85 + 0.3 * share if high - low > 0.02 else np.full_like(height, 1.0)
    image = table[kind] * (bright * tint * 1.25)[..., None]
    return np.clip(image, 0, 255).astype(np.uint8)
