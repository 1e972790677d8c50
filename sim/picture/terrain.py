"""Pictures of a ground: shaded relief in the colours of its kinds, from above and from aloft."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, U8
from datmo.messages import Kind
from sim.scan.embree import MISS, Mesh
from sim.scene.terrain import Terrain

PIXELS = 900
COLOURS = {Kind.ROAD: (120, 122, 128), Kind.SIDEWALK: (190, 178, 160), Kind.FIELD: (124, 142, 92)}
SKY = (214, 226, 236)
LIGHT = np.array([-0.55, 0.45, 0.70])
"""Towards the sun, from the upper left; maps are lit so, or hills look like hollows."""
AMBIENT, GAIN = 0.3, 1.25
STEEP = 0.5
"""Slope to which the steepest fiftieth of the ground is raised, at most `MOST_RAISED` times."""
MOST_RAISED = 20.0
ASIDE = np.array([-0.45, -1.0, 0.62])
AWAY = 2.1
"""From the middle of the ground towards the eye, and how far, in half sides of the ground."""


def terrain_picture(terrain: Terrain, pixels: int = PIXELS, exaggerate: float | None = None) -> U8:
    """The ground from above (h, w, 3), +y up, the longer side `pixels` long.

    Args:
        exaggerate: factor on the slopes that the light sees; null: so that the steep parts show.
    """
    xy, shape = _places(terrain, pixels)
    height, kind = terrain.height_at(xy), terrain.kind_at(xy)
    slope = _slope(terrain.normal_at(xy))
    factor = _factor(slope) if exaggerate is None else exaggerate
    return _paint(_lit(slope * factor), kind, height).reshape(*shape, 3)


def terrain_view(
    terrain: Terrain,
    pixels: int = PIXELS,
    eye: F64 | None = None,
    target: F64 | None = None,
    fov_deg: float = 45.0,
) -> U8:
    """The ground in perspective (h, w, 3), w = `pixels`, h = 0.6 w; slopes are shaded as they are.

    Args:
        eye, target: (3,) where from and whereto [m, world]; null: from the south-west, to the middle.
        fov_deg: from the left to the right side [deg].
    """
    x0, y0, x1, y1 = terrain.area
    middle = np.array([(x0 + x1) / 2, (y0 + y1) / 2])
    target = (
        np.append(middle, terrain.height_at(middle[None])) if target is None else np.asarray(target, float)
    )
    half = max(x1 - x0, y1 - y0) / 2
    eye = target + half * ASIDE * AWAY if eye is None else np.asarray(eye, float)
    directions, shape = _pinhole(target - eye, pixels, fov_deg)
    mesh = Mesh(terrain.vertices, terrain.triangles)
    origins = np.ascontiguousarray(np.broadcast_to(eye, directions.shape), np.float32)
    hits = mesh.cast(origins, directions.astype(np.float32))
    met = hits.distance < MISS
    place = eye + hits.distance[met, None] * directions[met]
    image = np.empty((len(directions), 3), np.uint8)
    image[:] = SKY
    image[met] = _paint(
        _lit(_slope(hits.normal[met].astype(float))), terrain.mesh_kind[hits.triangle[met] // 2], place[:, 2]
    )
    return image.reshape(*shape, 3)


def _pinhole(axis: F64, pixels: int, fov_deg: float) -> tuple[F64, tuple[int, int]]:
    """Unit directions (h w, 3) of the pixels, row by row from the top, and (h, w)."""
    h, w = round(0.6 * pixels), pixels
    forward = axis / np.sqrt(np.sum(axis**2))
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.sqrt(np.sum(right**2))
    up = np.cross(right, forward)
    scale = np.tan(np.deg2rad(fov_deg) / 2) * 2 / w
    across = (np.arange(w) + 0.5 - w / 2) * scale
    down = (np.arange(h) + 0.5 - h / 2) * scale
    ray = forward + across[None, :, None] * right - down[:, None, None] * up
    return np.asarray(ray / np.sqrt(np.sum(ray**2, -1))[..., None]).reshape(-1, 3), (h, w)


def _places(terrain: Terrain, pixels: int) -> tuple[F64, tuple[int, int]]:
    """World places (h w, 2) of the pixels' middles, row by row from the highest y, and (h, w)."""
    x0, y0, x1, y1 = terrain.area
    metres = max(x1 - x0, y1 - y0) / pixels
    w, h = (max(round(side / metres), 1) for side in (x1 - x0, y1 - y0))
    x = x0 + (np.arange(w) + 0.5) * (x1 - x0) / w
    y = y1 - (np.arange(h) + 0.5) * (y1 - y0) / h
    return np.column_stack([np.tile(x, h), np.repeat(y, w)]), (h, w)


def _slope(normal: F64) -> F64:
    """Rise along x and y (n, 2) of planes with these normals (n, 3)."""
    return np.asarray(-normal[:, :2] / normal[:, 2:])


def _factor(slope: F64) -> float:
    steep = float(np.quantile(np.hypot(slope[:, 0], slope[:, 1]), 0.98))
    return float(np.clip(STEEP / max(steep, 1e-6), 1.0, MOST_RAISED))


def _lit(slope: F64) -> F64:
    """Brightness (n,) of slopes (n, 2) under the light: Lambert's cosine."""
    light = LIGHT / np.sqrt(np.sum(LIGHT**2))
    cosine = light[2] - slope[:, 0] * light[0] - slope[:, 1] * light[1]
    return np.asarray(AMBIENT + (1 - AMBIENT) * np.maximum(cosine / np.sqrt(1 + np.sum(slope**2, -1)), 0.0))


def _paint(bright: F64, kind: U8, height: F64) -> U8:
    """Colours (n, 3) of kinds by brightness, lighter where higher."""
    table = np.full((256, 3), 128.0)
    for code, colour in COLOURS.items():
        table[code] = colour
    low, span = float(height.min()), float(np.ptp(height))
    tint = 0.85 + 0.3 * (height - low) / span if span > 0.02 else np.ones_like(height)
    return np.asarray(np.clip(table[kind] * (GAIN * bright * tint)[:, None], 0, 255), np.uint8)
