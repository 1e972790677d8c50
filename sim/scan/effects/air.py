"""Rain, snow and fog: how much light they take, and the echoes they send themselves.

Extinction alpha [1/m], from ITU-R P.1814 (2007): rain 1.076 R^0.67 dB/km, dry snow
(5.42e-5 lambda + 5.4958776) S^1.38 dB/km (lambda 905 nm); fog ln(20) / V, which is what the
meteorological optical range V means (WMO: a contrast of 5 % is left). Power falls by exp(-2 alpha r).

Rain drops follow Marshall and Palmer (1948), N(D) = 8000 exp(-4.1 R^-0.21 D); snow flakes Gunn and
Marshall (1958), N(D) = 3800 S^-0.87 exp(-2.55 S^-0.48 D), D the melted diameter, both in 1/(m³ mm).
A particle is seen when its echo beats the sensor's threshold and what stands behind: with the beam's
width w(r), rho (D / w)² overlap(r) / r² exp(-2 alpha r) > P. Those that do form a Poisson process along
the ray. Fog is too fine to count: its echo is that of its backscatter 0.046 / V (Rasshofer et al. 2011)
over the length of a pulse, and it is seen where it beats what stands behind.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from scenarios.spec import Weather

WAVELENGTH = 905.0  # [nm]
DECIBEL = np.log(10) / 10 / 1000  # of power, a km, to 1/m
DROP, FLAKE = np.pi / 4 * 0.02, 0.8
"""Reflectivity: a water sphere mirrors 2 % from its middle, which is R / 4 pi against a Lambert disc's
1 / pi; a flake scatters."""
FLUFF = 2.15  # a flake of a tenth of water's density is so much wider than its drop
APERTURE, DIVERGENCE = 0.01, 1.5e-3  # the beam's width is APERTURE + DIVERGENCE r [m]
PULSE = 0.75  # half the length of a 5 ns pulse [m]
BLIND, FULL = 0.9, 5.0
"""Emitter and receiver look through lenses of their own: what is nearer than BLIND is not seen at all,
beyond FULL wholly, between them by the square of the way. The figures are our assumption [m]; with them
fog of 100 m visibility begins to be seen."""
STEP = 0.5  # of the tables along the ray [m]
POWERS = np.geomspace(1e-7, 1e-1, 49)  # thresholds of the tables, rho / R² [1/m²]


def overlap(r: F64) -> F64:
    """Share (n,) of what comes from r (n,) [m] that the receiver sees."""
    return np.asarray(np.clip((r - BLIND) / (FULL - BLIND), 0, 1) ** 2)


def extinction(weather: Weather) -> float:
    """alpha [1/m]."""
    snow = (5.42e-5 * WAVELENGTH + 5.4958776) * weather.snow_mm_h**1.38 if weather.snow_mm_h else 0.0
    rain = 1.076 * weather.rain_mm_h**0.67 if weather.rain_mm_h else 0.0
    fog = np.log(20) / weather.fog_visibility_m if weather.fog_visibility_m is not None else 0.0
    return float(DECIBEL * (rain + snow) + fog)


def density(r: F64, power: F64, alpha: float, count: float, slope: float, shine: float, width: float) -> F64:
    """Seen particles a metre of ray (n,) at r [m] for a threshold `power` [1/m²].

    Args:
        count: N0 [1/(m³ mm)]. slope: Lambda [1/mm]. shine: reflectivity. width: of a particle by its D.
    """
    beam = APERTURE + DIVERGENCE * r
    gain = np.maximum(shine * overlap(r) * np.exp(-2 * alpha * r), 1e-30)
    least = 1e3 * beam * r * np.sqrt(power / gain) / width  # of D [mm]
    least = np.where(r > BLIND, least, np.inf)
    return np.asarray(np.pi / 4 * beam**2 * count / slope * np.exp(-slope * least))


@dataclass(frozen=True, eq=False)
class Air:
    """What the weather does to a ray, as tables over thresholds (p,) and ranges (q,).

    Attributes:
        alpha: extinction [1/m]. r: (q,) [m]. powers: (p,).
        rain, snow: (p, q) particles seen up to r. fog: (q,) its strongest echo [1/m²] up to r.
        fog_up_to: (q,) integral of the echo, for where along the ray it comes from.
    """

    alpha: float
    r: F64
    powers: F64
    rain: F64
    snow: F64
    fog: F64
    fog_up_to: F64

    @property
    def clear(self) -> bool:
        """Nothing in the air."""
        return self.alpha == 0


def air(weather: Weather, farthest: float) -> Air:
    """The tables of a weather, up to `farthest` [m]."""
    r = np.arange(0.0, farthest + STEP, STEP)
    alpha = extinction(weather)
    grid, power = r[None, :], POWERS[:, None]
    rain = snow = np.zeros((len(POWERS), len(r)))
    if weather.rain_mm_h:
        rain = density(grid, power, alpha, 8000.0, 4.1 * weather.rain_mm_h**-0.21, DROP, 1.0)
    if weather.snow_mm_h:
        count, slope = 3800 * weather.snow_mm_h**-0.87, 2.55 * weather.snow_mm_h**-0.48
        snow = density(grid, power, alpha, count, slope, FLAKE, FLUFF)
    back = 0.046 / weather.fog_visibility_m if weather.fog_visibility_m is not None else 0.0
    fog = np.pi * back * PULSE * overlap(r) * np.exp(-2 * alpha * r) / np.maximum(r, STEP) ** 2
    up_to = [np.cumsum((f[..., 1:] + f[..., :-1]) / 2, -1) * STEP for f in (rain, snow, fog)]
    padded = [np.concatenate([np.zeros((*f.shape[:-1], 1)), f], -1) for f in up_to]
    return Air(alpha, r, POWERS, padded[0], padded[1], np.maximum.accumulate(fog), padded[2])
