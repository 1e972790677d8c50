"""Returns of rain, snow and fog: they take the place of a weaker echo from behind, or of none."""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, U8, Bool
from datmo.messages import FalseReturn
from datmo.threads import blocks, spread
from sim.scan.caster import Hits
from sim.scan.effects.air import STEP, Air
from sim.scan.luck import Luck
from sim.scan.returns import FAINTEST, Returns
from sim.scan.surface import Surfaces

DROPS, FLAKES, PATCHES, PLACE = range(20, 24)
"""Streams of luck."""
PATCHY = 0.5  # standard deviation of the fog's log density from ray to ray
FAINT, BRIGHT = 0.02, 0.1  # intensity of drops and of flakes and fog
CODES = int(FalseReturn.RAIN), int(FalseReturn.SNOW), int(FalseReturn.FOG)
"""Handed to the kernel: a compiled one would keep those of the day it was compiled."""


@njit(cache=True, nogil=True)
def _first(table: F64, want: float, last: int) -> int:
    """First index at which a rising table exceeds `want`, -1 if not up to `last`."""
    if table[last] <= want:
        return -1
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if table[middle] > want:
            high = middle
        else:
            low = middle
    return high


@njit(cache=True, nogil=True)
def _fall(
    true: F32,
    power: F32,
    blind: Bool,
    tables: tuple[F64, F64, F64, F64, F64],
    chance: tuple[F32, F32, F32, F32],
    limits: tuple[float, float, float],
    codes: tuple[int, int, int],
    out: tuple[F32, F32, Bool, U8],
) -> None:
    """Put the particle or the fog that a ray sees in place of what it would have returned."""
    (powers, rain, snow, fog, fog_up_to), (drops, flakes, patches, place) = tables, chance
    (nearest, farthest, faintest), (is_rain, is_snow, is_fog) = limits, codes
    scale = (len(powers) - 1) / np.log(powers[-1] / powers[0])
    for n in range(len(true)):
        if blind[n]:
            continue
        end = min(true[n], farthest)
        last = min(int(end / STEP), rain.shape[1] - 1)
        behind = max(float(power[n]), faintest) if out[2][n] else faintest
        p = min(max(int(np.ceil(scale * np.log(behind / powers[0]))), 0), len(powers) - 1)
        at, code = -1, 0
        for table, lucky, name in ((rain, drops[n], is_rain), (snow, flakes[n], is_snow)):
            i = _first(table[p], -np.log(max(lucky, 1e-7)), last)
            if i >= 0 and (at < 0 or i < at):
                at, code = i, name
        strength = np.exp(PATCHY * patches[n])
        if at < 0 and fog_up_to[last] > 0.0 and strength * fog[last] > behind:
            at, code = _first(fog_up_to, place[n] * fog_up_to[last], last), is_fog
        if at >= 0 and at * STEP - place[n] * STEP >= nearest:
            out[0][n], out[2][n], out[3][n] = (at - place[n]) * STEP, True, code
            out[1][n] = FAINT if code == is_rain else BRIGHT


def add_weather(
    hits: Hits,
    met: Surfaces,
    blind: Bool,
    returns: Returns,
    air: Air,
    limits: tuple[float, float],
    luck: Luck,
) -> None:
    """Put the returns of what is in the air in place, ray by ray.

    Args:
        blind: (m,) rays that the ego's own body takes. air: see `effects.air`.
        limits: nearest and farthest measured range [m].
    """
    m = len(hits.distance)
    with np.errstate(over="ignore"):
        dim = np.exp(np.float32(-2 * air.alpha) * hits.distance) / hits.distance**2
    power = met.reflectance * dim
    tables = air.powers, air.rain, air.snow, air.fog, air.fog_up_to
    chance = luck.uniform(DROPS, m), luck.uniform(FLAKES, m), luck.normal(PATCHES, m), luck.uniform(PLACE, m)

    def fall(rays: slice) -> None:
        _fall(
            hits.distance[rays],
            power[rays],
            blind[rays],
            tables,
            (chance[0][rays], chance[1][rays], chance[2][rays], chance[3][rays]),
            (*limits, FAINTEST),
            CODES,
            (returns.distance[rays], returns.intensity[rays], returns.hit[rays], returns.false[rays]),
        )

    spread(fall, blocks(m))
