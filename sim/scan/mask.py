"""The ego's own body: the rays it blinds, whatever the scene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from datmo.arrays import Bool
from sim.scan.pattern import Pattern

KITTI = (
    (-180.0, -18.4),
    (-165.0, -18.6),
    (-164.5, -12.9),
    (-157.5, -12.9),
    (-157.0, -22.0),
    (-147.0, -25.0),
    (-138.0, -25.0),
    (-134.0, -21.0),
    (-122.0, -21.0),
    (-118.0, -26.0),
    (-79.0, -26.0),
    (-78.0, -18.0),
    (-72.0, -15.5),
    (-67.0, -15.5),
    (-61.0, -18.0),
    (-60.0, -26.0),
    (-31.0, -26.0),
    (-18.0, -23.0),
    (-11.0, -21.4),
    (11.0, -21.4),
    (17.0, -23.0),
    (26.0, -26.0),
    (118.0, -26.0),
    (122.0, -21.0),
    (134.0, -21.4),
    (138.0, -25.0),
    (147.0, -25.0),
    (157.0, -22.0),
    (157.5, -12.9),
    (164.5, -12.9),
    (165.0, -18.6),
    (180.0, -18.4),
)
"""Outline of the vehicle as the sensor on its roof sees it: azimuth, elevation [deg]. From rear to
rear: tail and roof, posts of the rack, a mast, the bonnet, and back. What five of its sweeps, of three
drives, have in common."""


def own_body(pattern: Pattern, outline: bool | str | Sequence[tuple[float, float]] = True) -> Bool:
    """Rays (L, C) that end on the ego's own body and so return nothing.

    A ray is lost where it points below the outline of the vehicle. KITTI's is a plain sketch
    fitted to the share of rays that its vehicle takes from each ring of an HDL-64E (0.22 of ring 56
    rising to 0.47 of ring 63: all beyond 160 degrees of azimuth, a window of some 40 degrees ahead).
    An outline is fixed to the sensor: a rack is taken to rise with it.

    Args:
        outline: True or "kitti", False for none, or points (azimuth, elevation) [deg].
    """
    if outline is False:
        return np.zeros((len(pattern.elevation), pattern.columns), bool)
    azimuth, elevation = np.array(KITTI if isinstance(outline, bool | str) else outline).T
    a = np.rad2deg(pattern.rotor[None, :] + pattern.azimuth[:, None])
    a = (a + 180) % 360 - 180
    return np.asarray(np.rad2deg(pattern.elevation)[:, None] < np.interp(a, azimuth, elevation))
