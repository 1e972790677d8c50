"""Buildings: facades with recessed windows under a gable or a flat roof."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from datmo.messages import Kind
from sim.scene.scenery import materials as m
from sim.scene.scenery.form import Form, join, loose

Size = tuple[float, float, float]
STOREY, BAY = 3.0, 3.0  # about so high and wide [m]
WINDOW = (1.2, 1.4, 0.9)  # width, height, height of the sill [m]
RECESS = 0.18  # depth of the panes behind the facade [m]
DEEP = 1.0  # facades go so far into the ground, which may slope [m]
PARAPET, EAVES = 0.5, 0.35  # of a flat roof, and how far a gable roof juts out [m]
PITCH = (30.0, 42.0)  # of a gable roof [deg]


def building(size: Size, seed: int) -> Form:
    """A house; x along its ridge."""
    rng = np.random.default_rng(seed)
    length, width, height = size
    shade = m.BRICK if rng.uniform() < 0.5 else m.RENDER
    pitch = np.deg2rad(rng.uniform(*PITCH))
    rise = float(np.tan(pitch)) * width / 2
    if rng.uniform() < 0.6 and height - rise > STOREY - 0.5:
        x, y, top = length / 2 - EAVES, width / 2 - EAVES, height - rise + EAVES * float(np.tan(pitch))
        roof = _gable(length / 2, width / 2, y, x, (height - rise, top, height), shade)
    else:
        x, y, top = length / 2, width / 2, height - PARAPET
        roof = _flat(x, y, height, shade)
    corners = np.array([[-x, y], [-x, -y], [x, -y], [x, y]])
    sides = [_facade(corners[i], corners[(i + 1) % 4], top, shade) for i in range(4)]
    return join([*sides, roof])


def _facade(start: F64, end: F64, top: float, shade: float) -> Form:
    """A facade from start to end (2,) [m], its outside to the right of that way."""
    along = end - start
    length = float(np.hypot(*along))
    along = along / length
    inward = np.array([-along[1], along[0]])
    bays, storeys = max(round(length / BAY), 1), max(round(top / STOREY), 1)
    wide, tall = length / bays, top / storeys
    u, v = (a.ravel() for a in np.meshgrid(np.arange(bays) * wide, np.arange(storeys) * tall))
    cell, pane = _bay(wide, tall)

    def placed(quads: F64) -> F64:
        flat = quads[None] + np.stack([u, v, np.zeros(len(u))], -1)[:, None, None]
        xy = start + flat[..., :1] * along + flat[..., 2:] * inward
        return np.concatenate([xy, flat[..., 1:2]], -1).reshape(-1, 4, 3)

    base = np.array([[*start, -DEEP], [*end, -DEEP], [*end, 0.0], [*start, 0.0]])
    plinth = loose(base[None], Kind.BUILDING, shade)
    foot = plinth.foot.copy()
    foot[:2] = base[:2, :2]  # the foot follows the ground, what is above stays level
    plinth = Form(plinth.vertices, foot, plinth.triangles, plinth.reflectivity, plinth.kind)
    return join(
        [
            plinth,
            loose(placed(cell), Kind.BUILDING, shade),
            loose(placed(pane), Kind.BUILDING, m.GLASS),
        ]
    )


def _bay(wide: float, tall: float) -> tuple[F64, F64]:
    """Quads (8, 4, 3) around a window and of its reveals, and its pane (1, 4, 3): along, up, inward [m]."""
    w, h = min(WINDOW[0], 0.7 * wide), min(WINDOW[1], 0.55 * tall)
    a, b = (wide - w) / 2, (wide + w) / 2
    c = min(WINDOW[2], 0.35 * tall)
    d, e = c + h, RECESS
    front = [
        [(0, 0), (wide, 0), (b, c), (a, c)],
        [(wide, 0), (wide, tall), (b, d), (b, c)],
        [(wide, tall), (0, tall), (a, d), (b, d)],
        [(0, tall), (0, 0), (a, c), (a, d)],
    ]
    rim = [(a, c), (b, c), (b, d), (a, d)]
    reveals = [[(*rim[i], 0), (*rim[(i + 1) % 4], 0), (*rim[(i + 1) % 4], e), (*rim[i], e)] for i in range(4)]
    around = [[(*corner, 0) for corner in quad] for quad in front]
    return np.array(around + reveals, float), np.array([[(*corner, e) for corner in rim]], float)


def _gable(
    x: float, y: float, wall: float, ends: float, levels: tuple[float, float, float], shade: float
) -> Form:
    """Two slopes over the half plan x, y and the gables at x = ±ends, half `wall` wide.

    Args:
        levels: of the eaves, of the gables' foot, of the ridge [m].
    """
    eaves, top, ridge = levels
    slopes = [[(-x, s * y, eaves), (x, s * y, eaves), (x, 0.0, ridge), (-x, 0.0, ridge)] for s in (-1.0, 1.0)]
    gables = [[(s * ends, -wall, top), (s * ends, wall, top), (s * ends, 0.0, ridge)] for s in (-1.0, 1.0)]
    return join(
        [
            loose(np.array(slopes), Kind.BUILDING, m.ROOF),
            loose(np.array(gables), Kind.BUILDING, shade),
        ]
    )


def _flat(x: float, y: float, height: float, shade: float) -> Form:
    """A roof behind a parapet."""
    ring = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    low, high = (np.column_stack([ring, np.full(4, z)]) for z in (height - PARAPET, height))
    parapet = np.stack([low, np.roll(low, -1, 0), np.roll(high, -1, 0), high], 1)
    return join([loose(parapet, Kind.BUILDING, shade), loose(low[None], Kind.BUILDING, m.ROOF)])
