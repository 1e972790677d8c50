"""From what a ray met to what the sensor reports: noise, lost returns, intensity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F32, U8, Bool
from scenarios.spec import Noise
from sim.scan.caster import Hits
from sim.scan.luck import Luck
from sim.scan.pool import blocks, spread
from sim.scan.surface import Surfaces

FAINTEST = 1.2e-6
"""Received power rho cos / R² [1/m²] at which half the returns are lost: asphalt (rho 0.1) seen at a
grazing angle from 1.9 m up at 55 m, as in street clouds of the HDL-64E."""
DIM = 2.0 * FAINTEST
"""Power at which half the returns report an intensity of 0: a quarter of the road at 30 m."""
ZEROS, SPECKLE, STEP = 0.03, 0.3, 0.01
RANGE, DROP_OUT, GRAZING, ZERO, SCATTER = range(5)
"""Streams of luck."""


@dataclass(frozen=True, eq=False)
class Returns:
    """What the sensor reports, (m,) each, ring by ring.

    Attributes:
        distance: measured [m], 0 where nothing returned. intensity: 0..1 in steps of 0.01.
        hit: bool, a return.
        false: uint8, `FalseReturn`: what made a return that lies on no surface, 0 where it lies on one.
    """

    distance: F32
    intensity: F32
    hit: Bool
    false: U8


@njit(cache=True, nogil=True)
def _report(
    true: F32,
    cosine: F32,
    surface: tuple[F32, F32],
    chance: tuple[F32, F32, F32, F32, F32],
    noise: tuple[float, float, bool, bool],
    alpha: float,
    limits: tuple[float, float],
    out: tuple[F32, F32, Bool],
) -> None:
    """Fill distance, intensity and hit of each ray; see `measure`."""
    (reflectivity, level), (normal, dropped, grazed, zero, scatter) = surface, chance
    (range_std, drop_out, grazing, speckle), (nearest, farthest) = noise, limits
    for r in range(len(true)):
        out[0][r], out[1][r], out[2][r] = 0.0, 0.0, False
        distance = true[r] + range_std * normal[r]
        if not (true[r] >= nearest and nearest <= distance <= farthest) or dropped[r] < drop_out:
            continue
        power = reflectivity[r] * cosine[r] / (true[r] * true[r])
        if alpha > 0.0:
            power *= np.exp(-2 * alpha * true[r])
        cube = power * power * power
        if grazing and grazed[r] * (cube + FAINTEST * FAINTEST * FAINTEST) >= cube:
            continue
        out[0][r], out[2][r] = distance, True
        mean = level[r]
        if speckle:
            dark = zero[r] < ZEROS + DIM / (DIM + power)
            mean = 0.0 if dark else min(max(mean * (1 + SPECKLE * scatter[r]), 0.0), 1.0)
        out[1][r] = np.round(mean / STEP) * STEP


def measure(
    hits: Hits, met: Surfaces, noise: Noise, alpha: float, limits: tuple[float, float], luck: Luck
) -> Returns:
    """Measure one sweep.

    Range: the true distance plus N(0, range_std), and nothing nearer or farther than `limits`. Link
    budget of a Lambertian surface that fills the beam (the lidar equation, e.g. Wagner et al.
    2006): power = rho cos(incidence) / R² exp(-2 alpha R); a return is lost with probability
    1 / (1 + (power / FAINTEST)³), so dark and grazing surfaces vanish far away. Apart from that, a
    share of isolated drop-outs. The sensor reports intensity already freed from range, speckled
    around the material's level, and 0 for weak returns.

    Every ray draws its own numbers whatever it met: the same seed gives the same luck in a
    changed scene.

    Args:
        alpha: extinction of the air [1/m]. limits: nearest and farthest measured range [m].
        luck: of this frame.
    """
    m = len(hits.distance)
    chance = (
        luck.normal(RANGE, m),
        luck.uniform(DROP_OUT, m),
        luck.uniform(GRAZING, m),
        luck.uniform(ZERO, m),
        luck.normal(SCATTER, m),
    )
    switches = noise.range_std, noise.drop_out, noise.grazing, noise.intensity
    out = np.empty(m, np.float32), np.empty(m, np.float32), np.empty(m, np.bool_)

    def report(rays: slice) -> None:
        _report(
            hits.distance[rays],
            hits.cosine[rays],
            (met.reflectivity[rays], met.level[rays]),
            (chance[0][rays], chance[1][rays], chance[2][rays], chance[3][rays], chance[4][rays]),
            switches,
            alpha,
            limits,
            (out[0][rays], out[1][rays], out[2][rays]),
        )

    spread(report, blocks(m))
    return Returns(*out, false=np.zeros(m, np.uint8))
