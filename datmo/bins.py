"""Edges of the polar bins: narrow near, wide far, as the rings of an HDL-64 fall on flat ground."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from datmo.errors import ConfigError

BINS, SEGMENTS = 120, 180
BLIND, RADIUS, SENSOR_HEIGHT = 2.0, 80.0, 1.73
FAR_SHARE = 0.65


def bin_edges(
    n: int = BINS, blind: float = BLIND, radius: float = RADIUS, height: float = SENSOR_HEIGHT
) -> F64:
    """Edges (n + 1,) of half-open bins in horizontal range [m], `blind` first, `radius` last.

    Beams with even steps of elevation e meet the ground at r = height / tan(e), so equal counts
    of beams mean equal steps of arctan(r / height). Far out such steps grow without end; a share
    of `FAR_SHARE` of the bins is therefore spread evenly in r:
    count(r) = n [FAR_SHARE (r - blind) / span + (1 - FAR_SHARE) (φ(r) - φ(blind)) / φ-span].
    The default bins are 0.06 m wide at 2 m, 0.5 m at 10 m and 1.0 m far out.

    Raises:
        ConfigError: fewer than one bin, or not 0 <= blind < radius, or height <= 0.
    """
    if n < 1 or not 0 <= blind < radius < np.inf or not height > 0:
        raise ConfigError(
            f"bins n={n}, blind={blind}, radius={radius}, height={height}: "
            "n must be at least 1, 0 <= blind < radius and height > 0; choose such numbers"
        )
    r = blind + (radius - blind) * np.linspace(0, 1, 20_001) ** 2
    angle = np.arctan(r / height)
    near = (angle - angle[0]) / (angle[-1] - angle[0])
    far = (r - blind) / (radius - blind)
    count = FAR_SHARE * far + (1 - FAR_SHARE) * near
    edges = np.interp(np.arange(n + 1) / n, count, r)
    edges[0], edges[-1] = blind, radius
    return edges
