"""From what a ray met to what the sensor reports: noise, lost returns, intensity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F32, Bool
from scenarios.spec import Noise
from sim.scan.caster import MIN_RANGE, Hits

FAINTEST = 1.2e-6
"""Received power rho cos / R² [1/m²] at which half the returns are lost: asphalt (rho 0.1) seen at a
grazing angle from 1.9 m up at 55 m, as in street clouds of the HDL-64E."""
DIM = 2.0 * FAINTEST
"""Power at which half the returns report an intensity of 0: a quarter of the road at 30 m."""
ZEROS, SPECKLE, STEP = 0.03, 0.3, 0.01


@dataclass(frozen=True, eq=False)
class Returns:
    """What the sensor reports, (m,) each, ring by ring.

    Attributes:
        distance: measured [m], 0 where nothing returned. intensity: 0..1 in steps of 0.01.
        hit: bool, a return.
    """

    distance: F32
    intensity: F32
    hit: Bool


@njit(cache=True, nogil=True)
def _report(
    true: F32,
    cosine: F32,
    surface: tuple[F32, F32],
    chance: tuple[F32, F32],
    noise: tuple[float, float, bool, float],
    out: tuple[F32, F32, Bool],
) -> None:
    """Fill distance, intensity and hit of each ray; see `measure`."""
    reflectivity, level = surface
    luck, normal = chance
    range_std, drop_out, grazing, max_range = noise
    for r in range(len(true)):
        out[0][r], out[1][r], out[2][r] = 0.0, 0.0, False
        distance = true[r] + range_std * normal[0, r]
        if not (true[r] >= MIN_RANGE and MIN_RANGE <= distance <= max_range) or luck[0, r] < drop_out:
            continue
        power = reflectivity[r] * cosine[r] / (true[r] * true[r])
        if grazing and luck[1, r] * (power**3 + FAINTEST**3) >= power**3:
            continue
        out[0][r], out[2][r] = distance, True
        if luck[2, r] >= ZEROS + DIM / (DIM + power):
            speckled = min(max(level[r] * (1 + SPECKLE * normal[1, r]), 0.0), 1.0)
            out[1][r] = np.round(speckled / STEP) * STEP


def measure(
    hits: Hits, reflectivity: F32, level: F32, noise: Noise, max_range: float, rng: np.random.Generator
) -> Returns:
    """Measure one sweep.

    Range: the true distance plus N(0, range_std), and nothing below `MIN_RANGE` or beyond
    `max_range`. Link budget of a Lambertian surface that fills the beam (the lidar equation, e.g.
    Wagner et al. 2006): power = rho cos(incidence) / R²; a return is lost with probability
    1 / (1 + (power / FAINTEST)³), so dark and grazing surfaces vanish far away. Apart from that, a
    share of isolated drop-outs. The sensor reports intensity already freed from range, speckled
    around the material's level, and 0 for weak returns.

    Every ray draws its own numbers whatever it met: the same seed gives the same luck in a
    changed scene.

    Args:
        reflectivity: (m,) rho. level: (m,) mean intensity. max_range: [m]. rng: of this frame.
    """
    m = len(hits.distance)
    luck = rng.random((3, m), dtype=np.float32)
    normal = rng.standard_normal((2, m), dtype=np.float32)
    out = Returns(np.empty(m, np.float32), np.empty(m, np.float32), np.empty(m, np.bool_))
    _report(
        hits.distance,
        hits.cosine,
        (reflectivity, level),
        (luck, normal),
        (noise.range_std, noise.drop_out, noise.grazing, max_range),
        (out.distance, out.intensity, out.hit),
    )
    return out
