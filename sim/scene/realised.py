"""The ISO 8608 class that profiles turn out to have, whatever they were meant to be.

ISO 8608:2016 reports the one-sided PSD of a profile's height smoothed in bands: octaves up to the centre
2^-5 cycles/m, thirds of an octave up to 2^-2, twelfths above. The class is that of Gd(n0) of the straight
line of exponent -2 through the smoothed PSD; class A ends at 32e-6 m³, and each next one at four times that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.errors import SimulationError
from sim.scene.roughness import CLASSES, HIGHEST, LOWEST, REFERENCE

WAVES = 3.0
"""The longest wave told apart fits this often into a profile; Hann's window blurs the ones beyond."""
ENDS = ((2.0**-5, 1), (2.0**-2, 3), (np.inf, 12))
"""Up to a centre frequency [cycles/m], so many bands an octave."""
NYQUIST_SHARE = 0.9
"""Of the highest frequency that the spacing can hold, above which nothing is used."""
NOTHING = 1e-12  # under this degree the profiles are flat [m³]


@dataclass(frozen=True, eq=False)
class Realised:
    """What was found.

    Attributes:
        roughness: "A" to "H", or "flat".
        degree: Gd(n0) at n0 = 0.1 cycles/m [m³].
        exponent: of the PSD over frequency; roads have about -2. NaN where flat.
        n, psd: (b,) centres [cycles/m] and smoothed one-sided PSD [m³] of the bands.
    """

    roughness: str
    degree: float
    exponent: float
    n: F64
    psd: F64


def realised_class(profiles: F64, step: float) -> Realised:
    """Class of the mean PSD of profiles, e.g. `terrain.height` with `terrain.cell`, or its transpose.

    Slopes are taken out; hills and bumps are not, and count as roughness where their waves lie within
    the band.

    Args:
        profiles: (m, n) heights, or (n,) of one [m]. step: between neighbours along a profile [m].

    Raises:
        SimulationError: they are not finite, or too short to tell an octave.
    """
    n, psd = smoothed(*periodogram(profiles, step))
    length = (np.asarray(profiles).shape[-1] - 1) * step
    low, high = max(LOWEST, WAVES / length), min(HIGHEST, NYQUIST_SHARE * 0.5 / step)
    inside = (n >= low) & (n <= high)
    if not (inside.any() and high >= 2 * low):
        raise SimulationError(
            f"profiles of {length:.1f} m at {step} m hold {low:.3g} to {high:.3g} cycles/m; "
            f"an octave is needed; give profiles longer than {2 * WAVES / max(high, 1e-9):.0f} m"
        )
    n, psd = n[inside], psd[inside]
    if psd.mean() * np.mean(n / REFERENCE) ** 2 < NOTHING:
        return Realised("flat", 0.0, float("nan"), n, psd)
    width = np.gradient(np.log(n))  # so that narrow bands do not outvote wide ones
    degree = float(np.exp(np.average(np.log(psd * (n / REFERENCE) ** 2), weights=width)))
    exponent = float(np.polyfit(np.log(n), np.log(psd), 1, w=np.sqrt(width))[0])
    row = np.clip(np.ceil(np.log(degree / 32e-6) / np.log(4.0)), 0, len(CLASSES) - 1)
    return Realised(CLASSES[int(row)], degree, exponent, n, psd)


def periodogram(profiles: F64, step: float) -> tuple[F64, F64]:
    """Frequencies [cycles/m] and one-sided PSD [m³], the mean over profiles (m, n), under Hann's window."""
    z = np.atleast_2d(np.asarray(profiles, float))
    if z.ndim != 2 or z.shape[1] < 8 or not np.isfinite(z).all():
        raise SimulationError(
            f"profiles of shape {z.shape}: they must be finite, (m, n >= 8); cut out what is not"
        )
    s = np.linspace(-1.0, 1.0, z.shape[1])
    slope = np.einsum("ij,j->i", z, s) / np.sum(s * s)
    z = z - z.mean(1, keepdims=True) - slope[:, None] * s
    window = np.hanning(z.shape[1])
    power = np.abs(np.fft.rfft(z * window)) ** 2
    psd = power.mean(0) * 2 * step / np.sum(window**2)
    return np.asarray(np.fft.rfftfreq(z.shape[1], step)), np.asarray(psd)


def smoothed(n: F64, psd: F64) -> tuple[F64, F64]:
    """Centres [cycles/m] and means of a PSD over ISO's bands; bins that an edge cuts count by their share."""
    width = n[1] - n[0]
    edge = np.concatenate([n - width / 2, [n[-1] + width / 2]])
    total = np.concatenate([[0.0], np.cumsum(psd * width)])
    low, high = bands(float(n[1]), float(n[-1]))
    held = np.interp(high, edge, total) - np.interp(low, edge, total)
    return np.sqrt(low * high), held / (high - low)


def bands(least: float, most: float) -> tuple[F64, F64]:
    """Lower and upper ends [cycles/m] of ISO's bands that lie between two frequencies."""
    edges = [2.0**-9.5]
    for last, parts in ENDS:
        while edges[-1] < last and edges[-1] < most:
            edges.append(edges[-1] * 2 ** (1 / parts))
    low, high = np.array(edges[:-1]), np.array(edges[1:])
    inside = (low >= least) & (high <= most)
    return low[inside], high[inside]
