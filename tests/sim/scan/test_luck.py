from __future__ import annotations

import numpy as np
from scipy import stats

from sim.scan.luck import Luck, _normals, _quantile, _uniforms

SEED = np.random.SeedSequence(7)


def splitmix64(seed: int, count: int) -> list[int]:
    """The generator as published: a state that grows by gamma, and a finaliser."""
    mask, state, words = 2**64 - 1, seed, []
    for _ in range(count):
        state = (state + 0x9E3779B97F4A7C15) & mask
        z = state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        words.append(z ^ (z >> 31))
    return words


def test_words_are_those_of_splitmix64() -> None:
    """First word of seed 1234567 as published with the generator: 6457827717110365317."""
    words = splitmix64(1234567, 400)
    assert words[0] == 6457827717110365317
    drawn = np.empty(400, np.float32)
    _uniforms(np.uint64(1234567), 0, drawn)
    np.testing.assert_array_equal(drawn, np.array([w >> 40 for w in words], np.float32) * 2.0**-24)
    normal = np.empty(400, np.float32)
    _normals(np.uint64(1234567), 0, normal)
    want = stats.norm.ppf([((w >> 32) + 0.5) * 2.0**-32 for w in words])
    np.testing.assert_allclose(normal, want, atol=2e-6)


def test_the_quantile_to_its_tails() -> None:
    p = np.concatenate([np.geomspace(1e-10, 0.5, 500), 1 - np.geomspace(1e-9, 0.5, 500)])
    np.testing.assert_allclose([_quantile(x) for x in p], stats.norm.ppf(p), rtol=2e-6, atol=2e-7)


def test_any_block_is_a_part_of_the_whole() -> None:
    whole, part = np.empty(1000, np.float32), np.empty(300, np.float32)
    for kernel in (_uniforms, _normals):
        kernel(np.uint64(99), 0, whole)
        kernel(np.uint64(99), 250, part)
        np.testing.assert_array_equal(part, whole[250:550])


def test_distributions_and_independence() -> None:
    luck, m = Luck(SEED), 200_000
    u, v, z = luck.uniform(0, m), luck.uniform(1, m), luck.normal(2, m)
    assert u.min() >= 0
    assert u.max() < 1
    assert stats.kstest(u, "uniform").pvalue > 1e-3
    assert stats.kstest(z, "norm").pvalue > 1e-3
    for a, b in ((u, v), (u, z), (u[1:], u[:-1]), (z[2083:], z[:-2083])):
        assert abs(np.corrcoef(a, b)[0, 1]) < 4 / np.sqrt(m)
    counts = np.histogram2d(u[::2], u[1::2], bins=20)[0].ravel()
    assert stats.chisquare(counts).pvalue > 1e-3


def test_streams_repeat_and_differ() -> None:
    a, b = Luck(SEED), Luck(np.random.SeedSequence(8))
    np.testing.assert_array_equal(a.uniform(3, 5000), Luck(SEED).uniform(3, 5000))
    assert not np.array_equal(a.uniform(3, 5000), a.uniform(4, 5000))
    assert not np.array_equal(a.uniform(3, 5000), b.uniform(3, 5000))
    np.testing.assert_array_equal(a.normal(5, 9000)[:4000], a.normal(5, 4000))
