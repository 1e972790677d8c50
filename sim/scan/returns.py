"""From what a ray met to what the sensor reports: noise, lost returns, intensity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F32, I32, U8, Bool
from datmo.threads import blocks, spread
from scenarios.spec import Noise
from sim.scan.caster import Hits
from sim.scan.luck import Luck, normal_number, uniform_number
from sim.scan.surface import Surfaces

FAINTEST, FADE = 1.4e-5, 4.5
"""Received power rho / R² [1/m²] at which half the returns are lost, and how steeply: asphalt (rho 0.1, of
which a grazing beam still sees 0.7, and a receiver focused at 24 m 0.6 of that) at 55 m, as in
street clouds of the HDL-64E. Its data sheet says 50 m for pavement (0.1) and 120 m for cars and foliage
(0.8): 4e-5 and 5.6e-5."""
WEAK = 4.5e-4
"""Power at which the variance of range has doubled. Fitted, like `Noise.range_std`, to the residuals of
11 neighbouring returns on roads and walls in five real sweeps: 7 mm on walls, 8 mm on the road at 6 m,
10 mm at 12 m, 22 mm at 35 m."""
DARKEST = 1e-6
"""Reflectance below which there is none to speak of."""
SURE = 30.0
"""From so many times that on a return is sure to 2e-7."""
DARK = 45.0
"""Range [m] at which half the returns report an intensity of 0, by a fifth power: 5 % at 25 m, 27 % at
37 m, 67 % at 52 m, 90 % at 70 m in real sweeps, on whatever surface."""
DIM, SCATTER, STEP = 0.01, 0.06, 0.01
"""Zeros at any range; standard deviation of intensity on one surface; step of intensity."""
BLUR = 35.0
"""Metres: a receiver focused at f sees 1 / (1 + (BLUR (1 / R - 1 / f))²) of what comes from R. Fitted to two
dark cars at 8.5 m in KITTI's odometry sequence 00, of which the upper block of lasers (focused at 24 m in
the S3 tables) loses most and the lower block (9.5 m) nothing."""
RANGE, DROP_OUT, GRAZING, ZERO, SPECKLE = range(5)
"""Streams of luck."""


@dataclass(frozen=True, eq=False)
class Returns:
    """What the sensor reports, (m,) each, ring by ring.

    Attributes:
        distance: measured [m], 0 where nothing returned. intensity: 0..1 in steps of 0.01.
        hit: bool, a return.
        false: `FalseReturn`: what made a return that lies on no surface, 0 where it lies on one.
        source: the ray whose surface a return lies on; its own, but for some at edges.
    """

    distance: F32
    intensity: F32
    hit: Bool
    false: U8
    source: I32


@dataclass(frozen=True, eq=False)
class Lasers:
    """What differs from laser to laser, (L,) each.

    Attributes:
        bias: of range [m]. gain: of intensity, 1 on the mean.
        sharp: one over the distance to which the receiver is focused [1/m], 0 where that is not known.
    """

    bias: F32
    gain: F32
    sharp: F32


@njit(cache=True, nogil=True)
def _report(
    rays: tuple[int, int],
    met: tuple[F32, F32, F32],
    keys: tuple[np.uint64, np.uint64, np.uint64, np.uint64, np.uint64],
    noise: tuple[float, float, bool, bool],
    air: tuple[float, float, float],
    lasers: tuple[F32, F32],
    out: tuple[F32, F32, Bool, I32],
) -> None:
    """Fill distance, intensity, hit and source of rays start..stop; see `measure`."""
    (true, reflectance, level), (normal, dropped, grazed, zero, scatter) = met, keys
    (range_std, drop_out, grazing, speckle), (alpha, nearest, farthest), (gain, sharp) = noise, air, lasers
    columns = len(true) // len(gain)
    for r in range(rays[0], rays[1]):
        out[0][r], out[1][r], out[2][r], out[3][r] = 0.0, 0.0, False, r
        R = float(true[r])
        if not nearest <= R or farthest < R or uniform_number(dropped, r) < drop_out:
            continue
        power = max(float(reflectance[r]), DARKEST) / (R * R)
        if alpha > 0.0:
            power *= np.exp(-2 * alpha * R)
        distance = R + range_std * np.sqrt(1 + WEAK / max(power, FAINTEST)) * normal_number(normal, r)
        if distance < nearest or distance > farthest:
            continue
        blur = BLUR * (1 / R - sharp[r // columns]) if sharp[r // columns] > 0 else 0.0
        seen = power / (1 + blur * blur)
        if grazing and seen < SURE * FAINTEST:
            odds = 1 + (FAINTEST / seen) ** FADE
            if uniform_number(grazed, r) * odds >= 1:
                continue
        out[0][r], out[2][r] = distance, True
        mean = float(level[r]) * gain[r // columns]
        if speckle:
            q = (R / DARK) * (R / DARK)
            q *= q * (R / DARK)
            dark = uniform_number(zero, r) < DIM + (1 - DIM) * q / (1 + q)
            mean = 0.0 if dark else mean + SCATTER * normal_number(scatter, r)
        out[1][r] = np.round(min(max(mean, 0.0), 1.0) / STEP) * STEP


def response_of(spread_of: float, rings: int, rng: np.random.Generator) -> F32:
    """Gain (rings,) of each laser's intensity, of mean 1 and standard deviation `spread_of`.

    Lasers answer the same surface differently (Levinson and Thrun, "Unsupervised calibration for
    multi-beam lasers", ISER 2010). On the roads of five real sweeps the 44 lower rings spread by
    26 %, a few far dimmer than the rest: a Gumbel distribution of the smallest.
    """
    z = (np.euler_gamma - rng.gumbel(size=rings)) * np.sqrt(6) / np.pi
    gain = np.maximum(1 + spread_of * z, 0.1)
    return np.asarray(gain / gain.mean(), np.float32)


def measure(
    hits: Hits,
    met: Surfaces,
    noise: Noise,
    alpha: float,
    limits: tuple[float, float],
    lasers: Lasers,
    luck: Luck,
) -> Returns:
    """Measure one sweep, by the link budget of a surface that fills the beam (the lidar equation, e.g.
    Wagner et al. 2006): power = rho / R² exp(-2 alpha R), rho its reflectance at this incidence.

    Range: the true distance plus N(0, s²), s² = range_std² (1 + WEAK / power), as noise of photons goes,
    and nothing nearer or farther than `limits`. A return is lost with probability
    1 / (1 + (seen / FAINTEST)^FADE), seen the power times the focus of the receiver (see `BLUR`): dark
    surfaces vanish far away, glass near by, and some lasers lose what others see.
    Apart from that, a share of isolated drop-outs. Intensity comes freed from range: the material's
    level at this incidence times the laser's gain plus N(0, SCATTER²), and 0 the more often the farther.

    Every ray draws its own numbers whatever it met: one seed, one luck, also in a changed scene.

    Args:
        alpha: extinction of the air [1/m]. limits: nearest and farthest measured range [m].
        lasers: what differs from laser to laser. luck: of this frame.
    """
    m = len(hits.distance)
    normal, dropped, grazed, zero, scatter = map(luck.key, (RANGE, DROP_OUT, GRAZING, ZERO, SPECKLE))
    keys = normal, dropped, grazed, zero, scatter
    switches = noise.range_std, noise.drop_out, noise.grazing, noise.intensity
    seen, each = (hits.distance, met.reflectance, met.level), (lasers.gain, lasers.sharp)
    out = np.empty(m, np.float32), np.empty(m, np.float32), np.empty(m, np.bool_), np.empty(m, np.int32)

    def report(rays: slice) -> None:
        _report((rays.start, rays.stop), seen, keys, switches, (alpha, *limits), each, out)

    spread(report, blocks(m))
    distance, intensity, hit, source = out
    return Returns(distance, intensity, hit, false=np.zeros(m, np.uint8), source=source)
