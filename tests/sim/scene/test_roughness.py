from __future__ import annotations

import numpy as np
import pytest
from scipy import integrate

from datmo.errors import SimulationError
from sim.scene.roughness import band, degree, profile_variance, rough_field, surface_psd

RMS_MM = {"A": 3.8, "B": 7.6, "C": 15.2, "D": 30.4, "E": 61, "F": 122, "G": 243.5, "H": 487}
CELL = 0.3


@pytest.mark.parametrize(("roughness", "rms"), RMS_MM.items())
def test_a_profile_over_the_whole_band_has_the_rms_of_its_class(roughness, rms):
    assert 1e3 * np.sqrt(profile_variance(roughness, 0.011, 2.83)) == pytest.approx(rms, rel=0.01)


@pytest.mark.parametrize("u", [0.011, 0.03, 0.1, 0.5, 1.2, 1.6])
def test_abel_integral_of_the_surface_gives_the_profile(u):
    """2 int S n dn / sqrt(n^2 - u^2) is half of Gd(u); n^2 = u^2 + v^2, v = w sin a meets both ends."""
    low, high = band(CELL)

    def inner(a):
        w = np.sqrt(high**2 - u**2)
        n = np.hypot(u, w * np.sin(a))
        return 2 * surface_psd(np.array(n), 1e-7, "C", low, high) * w * np.cos(a)

    found = integrate.quad(inner, 0, np.pi / 2, limit=400)[0]
    assert found == pytest.approx(degree("C") * (u / 0.1) ** -2 / 2, rel=1e-3)


def test_the_surface_falls_with_the_third_power():
    n = np.array([0.02, 0.04])
    psd = surface_psd(n, 1e-6, "A", 0.011, 1000.0)
    assert np.log2(psd[0] / psd[1]) == pytest.approx(3, abs=1e-3)
    assert psd[0] == pytest.approx(degree("A") * 0.01 / 4 / 0.02**3, rel=1e-3)


@pytest.fixture(scope="module")
def fields():
    return [rough_field((900, 1000), CELL, "E", np.random.SeedSequence(i)) for i in range(6)]


def _profile_psd(profiles):
    """One-sided PSD, averaged over rows, by the periodogram with Hann's window."""
    count = profiles.shape[1]
    window = np.hanning(count)
    power = np.abs(np.fft.rfft((profiles - profiles.mean(1, keepdims=True)) * window)) ** 2
    return np.fft.rfftfreq(count, CELL), power.mean(0) * 2 * CELL / np.sum(window**2)


@pytest.mark.parametrize("along", ["x", "y"])
def test_realised_profiles_have_level_and_slope_of_their_class_up_to_the_end_of_the_band(fields, along):
    pairs = [_profile_psd(f if along == "x" else f.T) for f in fields]
    n, psd = pairs[0][0], np.mean([p for _, p in pairs], 0)
    inside = (n > 0.03) & (n < 1.64)
    level = psd[inside] / (degree("E") * (n[inside] / 0.1) ** -2)
    assert np.exp(np.log(level).mean()) == pytest.approx(1, abs=0.02)
    assert np.polyfit(np.log(n[inside]), np.log(psd[inside]), 1)[0] == pytest.approx(-2, abs=0.02)
    for octave in (0.03, 0.06, 0.12, 0.25, 0.5, 0.82):
        part = level[(n[inside] >= octave) & (n[inside] < 2 * octave)]
        assert part.mean() == pytest.approx(1, abs=0.15 if octave < 0.1 else 0.05)


def test_the_realised_rms_is_that_of_the_band(fields):
    """The field holds pi / 2 of its profiles' in-band variance: what runs across them beside it."""
    variance = np.mean([f.var() for f in fields])
    expected = np.pi / 2 * profile_variance("E", *band(CELL))
    assert np.sqrt(variance) == pytest.approx(np.sqrt(expected), rel=0.1)


def test_opposite_edges_are_strangers():
    """In a field as wide as its period the last row would be the first one's neighbour."""
    slopes = np.diff(rough_field((1215, 500), CELL, "D", np.random.SeedSequence(2)), axis=1)
    assert np.corrcoef(slopes[0], slopes[1])[0, 1] > 0.5
    assert abs(np.corrcoef(slopes[0], slopes[-1])[0, 1]) < 0.25


def test_one_seed_one_field_and_classes_scale_it():
    seed = np.random.SeedSequence(5)
    a, b = (rough_field((40, 50), CELL, "A", seed) for _ in range(2))
    assert a.tobytes() == b.tobytes()
    assert np.allclose(rough_field((40, 50), CELL, "C", seed), 4 * a)
    assert not rough_field((40, 50), CELL, "flat", seed).any()


def test_an_unknown_class_is_refused():
    with pytest.raises(SimulationError, match="no ISO 8608 class"):
        degree("J")
