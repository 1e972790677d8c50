from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from scenarios.spec import IDEAL, Noise
from sim.scan.luck import Luck
from sim.scan.returns import (
    BLUR,
    DARK,
    DARKEST,
    DIM,
    DROP_OUT,
    FADE,
    FAINTEST,
    GRAZING,
    RANGE,
    SCATTER,
    SPECKLE,
    WEAK,
    ZERO,
    Lasers,
    Returns,
    measure,
    response_of,
)

LIMITS = (0.9, 80.0)
SEED = np.random.SeedSequence(21)
RINGS, COLUMNS = 8, 600
M = RINGS * COLUMNS


def street(seed: int = 0) -> tuple[SimpleNamespace, SimpleNamespace]:
    """Rays that met something at any range and angle, or nothing."""
    rng = np.random.default_rng(seed)
    distance = rng.uniform(0.3, 95, M).astype(np.float32)
    distance[::17] = np.inf
    hits = SimpleNamespace(distance=distance)
    rho = rng.uniform(0.0, 0.9, M).astype(np.float32) ** 3
    return hits, SimpleNamespace(reflectance=rho, level=(0.6 * rho).astype(np.float32))


def even(distance: float, rho: float = 0.5) -> tuple[SimpleNamespace, SimpleNamespace]:
    hits = SimpleNamespace(distance=np.full(40_000, distance, np.float32), cosine=np.ones(40_000, np.float32))
    met = SimpleNamespace(
        reflectance=np.full(40_000, rho, np.float32), level=np.full(40_000, 0.4, np.float32)
    )
    return hits, met


def each(gain: np.ndarray, focus: float = 0.0) -> Lasers:
    """Lasers of some gains, focused at a distance [m], 0 for none told."""
    sharp = np.full(len(gain), 1 / focus if focus else 0.0, np.float32)
    return Lasers(np.zeros(len(gain), np.float32), gain, sharp)


EVEN = each(np.ones(64, np.float32))


def reference(
    hits: SimpleNamespace, met: SimpleNamespace, noise: Noise, alpha: float, lasers: Lasers
) -> tuple[np.ndarray, np.ndarray]:
    """The model in plain Python: distance and intensity of each ray."""
    luck = Luck(SEED)
    error, scatter = luck.normal(RANGE, M), luck.normal(SPECKLE, M)
    dropped, grazed, zero = (luck.uniform(key, M) for key in (DROP_OUT, GRAZING, ZERO))
    distance, intensity = np.zeros(M, np.float32), np.zeros(M, np.float32)
    for r in range(M):
        R = float(hits.distance[r])
        if not LIMITS[0] <= R <= LIMITS[1] or dropped[r] < noise.drop_out:
            continue
        power = max(float(met.reflectance[r]), DARKEST) / R**2 * np.exp(-2 * alpha * R)
        got = R + noise.range_std * np.sqrt(1 + WEAK / max(power, FAINTEST)) * float(error[r])
        gain, sharp = float(lasers.gain[r // COLUMNS]), float(lasers.sharp[r // COLUMNS])
        focused = 1 / (1 + (BLUR * (1 / R - sharp)) ** 2) if sharp > 0 else 1.0
        lost = noise.grazing and grazed[r] >= 1 / (1 + (FAINTEST / (power * focused)) ** FADE)
        if lost or not LIMITS[0] <= got <= LIMITS[1]:
            continue
        mean = float(met.level[r]) * gain
        if noise.intensity:
            dark = DIM + (1 - DIM) / (1 + (DARK / R) ** 5)
            mean = 0.0 if zero[r] < dark else mean + SCATTER * float(scatter[r])
        distance[r], intensity[r] = got, round(min(max(mean, 0.0), 1.0) * 100) / 100
    return distance, intensity


@pytest.mark.parametrize("noise", [Noise(), IDEAL, Noise(drop_out=0.2, intensity=False)])
@pytest.mark.parametrize("alpha", [0.0, 0.01])
@pytest.mark.parametrize("focus", [0.0, 12.0])
def test_the_kernel_is_the_model(noise: Noise, alpha: float, focus: float) -> None:
    hits, met = street()
    lasers = each(response_of(noise.response, RINGS, np.random.default_rng(3)), focus)
    got = measure(hits, met, noise, alpha, LIMITS, lasers, Luck(SEED))
    distance, intensity = reference(hits, met, noise, alpha, lasers)
    np.testing.assert_array_equal(got.hit, distance > 0)
    np.testing.assert_allclose(got.distance, distance, rtol=1e-6)
    np.testing.assert_allclose(got.intensity, intensity, atol=1e-6)
    np.testing.assert_array_equal(got.source, np.arange(M))
    assert not got.false.any()
    assert 0.2 < got.hit.mean() < 0.95


def test_the_noise_of_range_grows_as_photons_grow_few() -> None:
    for R, rho in ((3.0, 0.5), (12.0, 0.3), (35.0, 0.4)):
        got = measure(*even(R, rho), Noise(drop_out=0), 0.0, LIMITS, EVEN, Luck(SEED))
        error = got.distance[got.hit] - R
        want = 0.0075 * np.sqrt(1 + WEAK * R**2 / rho)
        assert error.std() == pytest.approx(want, rel=0.03)
        assert abs(error.mean()) < 5 * want / 200


def test_what_is_dark_and_far_is_lost() -> None:
    """Half of the returns at the faintest power."""
    R = 40.0
    noise = IDEAL.model_copy(update={"grazing": True})
    got = measure(*even(R, FAINTEST * R**2), noise, 0.0, LIMITS, EVEN, Luck(SEED))
    assert got.hit.mean() == pytest.approx(0.5, abs=0.01)


def test_intensity_scatters_about_its_level_times_the_lasers_gain() -> None:
    gain = np.repeat(np.array([0.5, 1.0, 1.5, 1.0], np.float32), 2)
    got = measure(*even(5.0), Noise(drop_out=0), 0.0, LIMITS, each(gain), Luck(SEED))
    rows = got.intensity.reshape(8, -1)
    for ring, factor in enumerate(gain):
        seen = rows[ring][rows[ring] > 0]
        assert seen.mean() == pytest.approx(0.4 * factor, abs=0.005)
        assert seen.std() == pytest.approx(SCATTER, rel=0.06)
    assert (rows == 0).mean() == pytest.approx(DIM, abs=0.004)


def test_lasers_answer_by_as_much_as_asked_and_one_on_the_mean() -> None:
    gain = response_of(0.25, 20_000, np.random.default_rng(0))
    assert gain.mean() == pytest.approx(1, abs=1e-6)
    assert gain.std() == pytest.approx(0.25, rel=0.05)
    assert (gain < 0.4).mean() > (gain > 1.6).mean()  # a few far dimmer
    np.testing.assert_array_equal(response_of(0, 64, np.random.default_rng(0)), np.ones(64, np.float32))


def test_a_ray_has_its_own_luck_whatever_the_others_meet() -> None:
    hits, met = street()
    moved = SimpleNamespace(distance=hits.distance.copy())
    moved.distance[:100] = np.inf
    gain = np.ones(RINGS, np.float32)
    one, other = (measure(h, met, Noise(), 0.0, LIMITS, each(gain), Luck(SEED)) for h in (hits, moved))
    assert isinstance(one, Returns)
    np.testing.assert_array_equal(one.distance[100:], other.distance[100:])
    assert not other.hit[:100].any()


def test_a_receiver_sees_best_at_its_focus() -> None:
    """Half the returns are lost where power times focus is the faintest."""
    noise = IDEAL.model_copy(update={"grazing": True})
    for focus, R in ((24.0, 8.0), (9.5, 8.0), (24.0, 50.0)):
        sharp = 1 / (1 + (BLUR * (1 / R - 1 / focus)) ** 2)
        dark = FAINTEST * R**2 / sharp
        lasers = each(np.ones(64, np.float32), focus)
        got = measure(*even(R, dark), noise, 0.0, LIMITS, lasers, Luck(SEED))
        assert got.hit.mean() == pytest.approx(0.5, abs=0.01)
