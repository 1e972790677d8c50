"""Random numbers by counter: every ray has its own, whatever it met and whoever draws them.

The n-th word of a stream with key k is the n-th output of SplitMix64 seeded with k (Steele, Lea and
Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014): mix(k + (n + 1) * gamma). It is
a function of k and n alone, so blocks can be drawn in any order on any number of threads.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F32, I64
from datmo.threads import blocks, spread

GAMMA = np.uint64(0x9E3779B97F4A7C15)
UNIT = np.float32(2.0**-24)


@njit(cache=True, nogil=True)
def _word(key: np.uint64, n: int) -> np.uint64:
    """Word n of a stream."""
    z = key + np.uint64(n + 1) * GAMMA
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@njit(cache=True, nogil=True)
def _quantile(p: float) -> float:
    """The standard normal quantile, algorithm PPND7 of Wichura (AS 241, 1988), to 1e-7."""
    q = p - 0.5
    if abs(q) <= 0.425:
        r = 0.180625 - q * q
        above = ((59.109374720 * r + 159.29113202) * r + 50.434271938) * r + 3.3871327179
        return float(q * above / (((67.187563600 * r + 78.757757664) * r + 17.895169469) * r + 1.0))
    r = np.sqrt(-np.log(min(p, 1.0 - p)))
    if r <= 5.0:
        r -= 1.6
        x = ((0.17023821103 * r + 1.3067284816) * r + 2.7568153900) * r + 1.4234372777
        x /= (0.12021132975 * r + 0.73700164250) * r + 1.0
    else:
        r -= 5.0
        x = ((0.017337203997 * r + 0.42868294337) * r + 3.0812263860) * r + 6.6579051150
        x /= (0.012258202635 * r + 0.24197894225) * r + 1.0
    return float(-x if q < 0 else x)


@njit(cache=True, nogil=True)
def uniform_number(key: np.uint64, n: int) -> np.float32:
    """Number n of a stream, uniform in [0, 1): a multiple of 2^-24."""
    return np.float32(_word(key, n) >> np.uint64(40)) * UNIT


@njit(cache=True, nogil=True)
def normal_number(key: np.uint64, n: int) -> np.float32:
    """Number n of a stream, standard normal: the quantile at the middle of one of 2^32 equal steps."""
    return np.float32(_quantile((np.float64(_word(key, n) >> np.uint64(32)) + 0.5) * 2.0**-32))


@njit(cache=True, nogil=True)
def _uniforms(key: np.uint64, start: int, out: F32) -> None:
    for i in range(len(out)):
        out[i] = uniform_number(key, start + i)


@njit(cache=True, nogil=True)
def _uniforms_at(key: np.uint64, counters: I64, out: F32) -> None:
    for i in range(len(out)):
        out[i] = uniform_number(key, counters[i])


@njit(cache=True, nogil=True)
def _normals(key: np.uint64, start: int, out: F32) -> None:
    for i in range(len(out)):
        out[i] = normal_number(key, start + i)


class Luck:
    """The random numbers of one frame, a stream for each name, one number for each of m rays.

    Switching an effect on or off does not change what another one draws.

    Args:
        seed: of the frame.
    """

    def __init__(self, seed: np.random.SeedSequence) -> None:
        self._seed = seed

    def uniform(self, stream: int, m: int) -> F32:
        """(m,) in [0, 1)."""
        return self._draw(_uniforms, stream, m)

    def uniform_at(self, stream: int, rays: I64) -> F32:
        """What `uniform` gives to some rays (n,)."""
        out = np.empty(len(rays), np.float32)
        _uniforms_at(self.key(stream), rays, out)
        return out

    def normal(self, stream: int, m: int) -> F32:
        """(m,) of mean 0 and variance 1."""
        return self._draw(_normals, stream, m)

    def key(self, stream: int) -> np.uint64:
        """For kernels that draw `uniform_number` or `normal_number` themselves, of the rays that need one."""
        child = np.random.SeedSequence(self._seed.entropy, spawn_key=(*self._seed.spawn_key, stream))
        return np.uint64(child.generate_state(1, np.uint64)[0])

    def _draw(self, kernel: object, stream: int, m: int) -> F32:
        key = self.key(stream)
        out = np.empty(m, np.float32)
        spread(lambda rows: kernel(key, rows.start, out[rows]), blocks(m, 8))  # type: ignore[operator]
        return out
