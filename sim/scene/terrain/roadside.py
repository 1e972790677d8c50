"""What follows the edges of the roads: kerbs with their sidewalk, and ditches."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from datmo.arrays import F64, Bool
from scenarios.spec import layers as spec
from sim.scene.roads import Road, beyond_edge
from sim.scene.terrain.grid import Grid

GUTTER = 0.1
"""A kerb stands so far beyond the edge, and a seam between lanes narrower than twice this is none [m]."""
ISLAND = 60.0
"""What lanes enclose is paved where it is smaller than this [m²]."""


def smooth_step(u: F64) -> F64:
    """0 up to u = 0, 1 from u = 1 on, level at both: u² (3 - 2 u)."""
    u = np.clip(u, 0.0, 1.0)
    return np.asarray(u * u * (3 - 2 * u))


def paved(beyond: F64, grid: Grid) -> F64:
    """Distances beyond the roads' edge, 0 on the small islands that the lanes of a crossing enclose."""
    labels, count = ndimage.label(beyond > 0)
    area = np.bincount(labels.ravel(), minlength=count + 1) * grid.cell**2
    small: Bool = area < ISLAND
    rim = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    small[rim] = False
    small[0] = False
    return np.where(small[labels], 0.0, beyond)


def kerb(layer: spec.Kerb, beyond: F64, cell: float) -> F64:
    """Heights [m]: up over one cell from the gutter on, level, and down over the verge.

    Args:
        beyond: distances beyond the roads' edge [m].
    """
    behind = beyond - GUTTER
    return (
        layer.height
        * np.clip(behind / cell, 0, 1)
        * (1 - smooth_step((behind - layer.sidewalk) / layer.verge))
    )


def ditch(layer: spec.Ditch, beyond: F64, share: F64, grid: Grid) -> F64:
    """Heights [m] of a trapezoid, -d clip((W/2 - |t|) / ((W - B)/2), 0, 1), t from the ditch's middle.

    Args:
        beyond: distances beyond the roads' edge, true up to the ditch's far side [m].
        share: of the field, 0 on the roads to 1 beyond their shoulder: a ditch ends with it.
    """
    if layer.path is None:
        t = np.abs(beyond - layer.offset - layer.width / 2)
    else:
        line, narrow = np.array(layer.path), 1e-3
        t = (
            beyond_edge([Road(line, narrow)], grid.shape, (grid.x0, grid.y0), grid.cell, layer.width)
            + narrow / 2
        )
    slope = (layer.width - layer.bottom) / 2
    trench = -layer.depth * np.clip((layer.width / 2 - t) / slope, 0.0, 1.0)
    return np.asarray(trench if layer.path is None else trench * share)


def depth_of_interest(layers: tuple[spec.Layer, ...], shoulder: float) -> float:
    """How far beyond the roads' edge distances must be true [m]."""
    reach = shoulder
    for layer in layers:
        if isinstance(layer, spec.Kerb):
            reach = max(reach, GUTTER + layer.sidewalk + max(layer.verge, shoulder))
        elif isinstance(layer, spec.Ditch) and layer.path is None:
            reach = max(reach, layer.offset + layer.width)
    return reach + GUTTER
