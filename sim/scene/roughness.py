"""Rough ground: an isotropic random field whose profiles are ISO 8608 roads.

ISO 8608:2016 gives the one-sided PSD of a profile's height, for n in cycles/m [m^3]:

    Gd(n) = Gd(n0) (n / n0)^-2,   n0 = 0.1 cycles/m,   Gd(n0) = 16 * 4^i * 1e-6 m^3,  i = 0 (A) .. 7 (H)

A surface S(nx, ny) = S(n), n = |(nx, ny)|, two-sided, has profiles of the two-sided PSD
P(u) = 2 int_u^inf S(n) n dn / sqrt(n^2 - u^2) (integrate over ny: an Abel transform). We want
P(u) = Gd(u) / 2 = 2 C / u^2 with C = Gd(n0) n0^2 / 4 up to n2, and nothing beyond. Abel's inverse,
S(n) = -1/pi int_n^n2 P'(u) du / sqrt(u^2 - n^2), gives with t = arccos(n / n2)

    S(n) = 2 C / (pi n^3) (t + sin t cos t)  +  2 C / (pi n2^2 sqrt(n2^2 - n^2))

The first term is the slope of P and tends to C / n^3 (exponent -3, not -2) where n << n2; the second
is the end of the band, where P drops to zero. Without it a profile would lack sqrt(1 - (u / n2)^2).

Below n1 the field holds nothing. S above n1 is fixed by P above n1, so this is the least that any
isotropic field with these profiles can hold. Waves that run across a profile still show in it below
n1 (P tends to C / n1^2 there), so the field's variance, 2 pi C / n1 for wide bands, is pi/2
of the variance 4 C (1 / n1 - 1 / n2) which its profiles hold within the band.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import fft

from datmo.arrays import F64
from datmo.errors import SimulationError, nearest

CLASSES = "ABCDEFGH"
REFERENCE = 0.1  # n0 [cycles/m]
LOWEST = 0.011  # the band over which ISO 8608 reports roads [cycles/m]
HIGHEST = 2.83
WAVES = 4  # the period holds at least so many of the longest waves, so that the band's foot is resolved


def degree(roughness: str) -> float:
    """Gd(n0) [m^3] of an ISO 8608 class, its geometric mean; 0 for "flat".

    Raises:
        SimulationError: there is no such class.
    """
    if roughness == "flat":
        return 0.0
    if len(roughness) != 1 or roughness not in CLASSES:
        raise SimulationError(
            f"roughness {roughness!r} is no ISO 8608 class; {nearest(roughness, ('flat', *CLASSES))}"
        )
    return float(16e-6 * 4 ** CLASSES.index(roughness))


def band(cell: float) -> tuple[float, float]:
    """Lowest and highest spatial frequency [cycles/m] on a grid of spacing `cell` [m]."""
    return LOWEST, min(HIGHEST, 0.5 / cell)


def profile_variance(roughness: str, low: float, high: float) -> float:
    """Variance [m^2] that a profile holds between two frequencies [cycles/m] of the band."""
    return degree(roughness) * REFERENCE**2 * (1 / low - 1 / high)


def surface_psd(n: F64, step: float, roughness: str, low: float, high: float) -> F64:
    """Two-sided PSD [m^4] of the surface at radial frequencies n [cycles/m], of any shape.

    The singular end of the band is averaged over a bin's width `step` [cycles/m].
    """
    C = degree(roughness) * REFERENCE**2 / 4
    t = np.arccos(np.minimum(n / high, 1.0))
    slope = (t + np.sin(t) * np.cos(t)) / np.maximum(n, low) ** 3
    over = np.arcsin(np.minimum((n + step / 2) / high, 1.0))
    under = np.arcsin(np.clip((n - step / 2) / high, -1.0, 1.0))
    end = (over - under) / step / high**2
    return np.where(n >= low, 2 * C / np.pi * (slope + end), 0.0)


def rough_field(shape: tuple[int, int], cell: float, roughness: str, seed: np.random.SeedSequence) -> F64:
    """Heights (ny, nx) [m] of one draw of the field, of mean zero over its own period.

    Args:
        shape: rows (y) and columns (x). cell: spacing [m].
    """
    return rough_fields(shape, cell, [(roughness, seed)])[0]


def rough_fields(
    shape: tuple[int, int], cell: float, draws: Sequence[tuple[str, np.random.SeedSequence]]
) -> list[F64]:
    """Fields of several classes and seeds on one grid, as `rough_field` gives each.

    White noise is coloured by sqrt(S): its sum over a bin's area makes the variance. The field is
    periodic, and the period is wider than the grid by at least half the longest wave, so that
    opposite edges are not joined. A class is a multiple of class A, by a power of two.
    """
    low, high = band(cell)
    room = [max(WAVES / low, n * cell + 0.5 / low) for n in shape]
    ny, nx = (fft.next_fast_len(int(np.ceil(r / cell)), real=True) for r in room)
    gain: F64 | None = None
    fields = []
    for roughness, seed in draws:
        factor = np.sqrt(degree(roughness) / degree("A"))
        if factor == 0:
            fields.append(np.zeros(shape))
            continue
        gain = _gain(ny, nx, cell, low, high) if gain is None else gain
        noise = fft.rfft2(np.random.default_rng(seed).standard_normal((ny, nx)))
        field = fft.irfft2(noise * (factor * gain), s=(ny, nx))
        fields.append(np.ascontiguousarray(field[: shape[0], : shape[1]]))
    return fields


def _gain(ny: int, nx: int, cell: float, low: float, high: float) -> F64:
    """What colours white noise (ny, nx) to class A, over the bins of its real transform."""
    n = np.hypot(fft.fftfreq(ny, cell)[:, None], fft.rfftfreq(nx, cell)[None, :])
    step = 1 / (cell * np.sqrt(nx * ny))
    return np.asarray(np.sqrt(surface_psd(n, step, "A", low, high)) / cell)
