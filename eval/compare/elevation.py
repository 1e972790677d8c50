"""Elevation of each ring against the table of its unit."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F32, F64, U8
from eval.compare.profile import FEWEST
from sim.scan.units import Unit


def errors(points: F32, ring: U8, unit: Unit) -> F64:
    """Median angle (L,) by which the returns of each ring lie above their laser's beam [deg].

    The beam of elevation V starts v above the origin: at a distance x along the ground it is at
    z = x tan V + v / cos V (see `sim.scan.units.Unit`). NaN where returns are few.

    Args:
        points: (n, 3) [m, sensor at the return's own time]. ring: (n,).
    """
    xyz = np.asarray(points, float)
    x, V = np.hypot(xyz[:, 0], xyz[:, 1]), unit.elevation[ring]
    beam = x * np.tan(V) + unit.vertical_offset[ring] / np.cos(V)
    off = np.degrees(np.arctan2(xyz[:, 2], x) - np.arctan2(beam, x))
    each = [off[ring == r] for r in range(unit.rings)]
    return np.array([np.median(o) if len(o) >= FEWEST else np.nan for o in each])
