"""From what a ray met to what the sensor reports: noise, lost returns, intensity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, Bool
from scenarios.spec import Noise
from sim.scan.caster import MIN_RANGE, Hits

FAINTEST = 1.2e-6
"""Received power rho cos / R² [1/m²] at which half the returns are lost: asphalt (rho 0.1) seen at a
grazing angle from 1.9 m up at 55 m, as in street clouds of the HDL-64E."""
STEEPNESS = 3.0
"""Exponent of the loss in power; how sharply returns vanish around `FAINTEST`."""
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


def _survives(power: F32, noise: Noise, luck: F32) -> Bool:
    """Whether each return is strong enough, and not dropped; `luck` (2, m) uniform."""
    kept = luck[0] >= noise.drop_out
    if noise.grazing:
        with np.errstate(divide="ignore"):
            kept &= luck[1] * (1 + (FAINTEST / power) ** STEEPNESS) < 1
    return np.asarray(kept)


def measure(
    hits: Hits, reflectivity: F32, level: F32, noise: Noise, max_range: float, rng: np.random.Generator
) -> Returns:
    """Measure one sweep.

    Range: the true distance plus N(0, range_std), and nothing below `MIN_RANGE` or beyond
    `max_range`. Link budget of a Lambertian surface that fills the beam (the lidar equation, e.g.
    Wagner et al. 2006): power = rho cos(incidence) / R²; a return is lost with probability
    1 / (1 + (power / FAINTEST)^STEEPNESS), so dark and grazing surfaces vanish far away. Apart
    from that, a share of isolated drop-outs. The sensor reports intensity already freed from
    range, speckled around the material's level, and 0 for weak returns.

    Every ray draws its own numbers whatever it met: the same seed gives the same luck in a
    changed scene.

    Args:
        reflectivity: (m,) rho. level: (m,) mean intensity. max_range: [m]. rng: of this frame.
    """
    m = len(hits.distance)
    luck = rng.random((3, m), dtype=np.float32)
    normal = rng.standard_normal((2, m), dtype=np.float32)
    true = np.where(np.isfinite(hits.distance), hits.distance, np.float32(0))
    near = np.maximum(true, np.float32(MIN_RANGE))
    power = reflectivity * hits.cosine / (near * near)
    distance = true + np.float32(noise.range_std) * normal[0]
    hit = (true >= MIN_RANGE) & (distance >= MIN_RANGE) & (distance <= max_range)
    hit &= _survives(power, noise, luck[:2])
    speckled = level * np.maximum(1 + np.float32(SPECKLE) * normal[1], 0)
    speckled[luck[2] < ZEROS + DIM / (DIM + power)] = 0
    intensity = np.round(np.clip(speckled, 0, 1) / STEP).astype(np.float32) * np.float32(STEP)
    zero = np.float32(0)
    return Returns(np.where(hit, distance, zero), np.where(hit, intensity, zero), hit)
