from __future__ import annotations

import numpy as np
import pytest

from datmo.errors import SimulationError
from scenarios import spec
from sim.scene.realised import bands, periodogram, realised_class, smoothed
from sim.scene.roads import Road
from sim.scene.roughness import CLASSES, degree
from sim.scene.terrain import build_terrain


@pytest.mark.parametrize("roughness", CLASSES)
def test_each_class_realises_itself_along_and_across(roughness):
    cell = 0.5
    terrain = build_terrain(
        spec.Terrain(roughness=roughness, grade=0.1, cell=cell),
        [],
        (0, 0, 300, 300),
        np.random.SeedSequence(8),
    )
    for profiles in (terrain.height, terrain.height.T):
        found = realised_class(profiles, cell)
        assert found.roughness == roughness
        assert found.degree == pytest.approx(degree(roughness), rel=0.12)
        assert found.exponent == pytest.approx(-2, abs=0.08)


def test_road_and_field_of_one_ground_each_realise_their_own():
    road = Road(np.array([[-50.0, 0.0], [450.0, 0.0]]), 16.0)
    ground = spec.Terrain(roughness="E", road_roughness="B", cell=0.5)
    terrain = build_terrain(ground, [road], (0, -60, 400, 60), np.random.SeedSequence(1))
    y = np.abs(terrain.y0 + terrain.cell * np.arange(len(terrain.height)))
    assert realised_class(terrain.height[y < 8], 0.5).roughness == "B"
    assert realised_class(terrain.height[y > 11.5], 0.5).roughness == "E"
    assert terrain.roughness_at(np.array([[100.0, 0.0], [100.0, 30.0]])).tolist() == ["B", "E"]


def test_a_wave_holds_half_its_amplitude_squared():
    s = 0.25 * np.arange(4000)
    n, psd = periodogram(0.3 * np.sin(2 * np.pi * 0.2 * s), 0.25)
    assert np.sum(psd) * n[1] == pytest.approx(0.3**2 / 2, rel=1e-3)
    assert n[np.argmax(psd)] == pytest.approx(0.2, abs=n[1])


def test_smoothing_an_exact_road_gives_its_line_back_at_the_geometric_centres():
    """The mean of n^-2 over a band is that at its geometric centre."""
    n = np.arange(0, 4000) * 0.0005
    psd = degree("C") * (np.maximum(n, 1e-9) / 0.1) ** -2
    psd[0] = 0
    centre, mean = smoothed(n, psd)
    wide = centre > 0.02
    assert mean[wide] == pytest.approx(degree("C") * (centre[wide] / 0.1) ** -2, rel=2e-3)


def test_bands_are_octaves_then_thirds_then_twelfths_and_leave_no_gap():
    low, high = bands(0.002, 3.0)
    assert low[1:] == pytest.approx(high[:-1])
    centre = np.sqrt(low * high)
    parts = 1 / np.log2(high / low)
    assert parts[centre < 0.04] == pytest.approx(1.0)
    assert parts[(centre > 0.045) & (centre < 0.25)] == pytest.approx(3.0)
    assert parts[centre > 0.3] == pytest.approx(12.0)
    assert np.isclose(centre, 2.0**-5).any()


def test_flat_ground_is_flat_and_a_slope_is_no_roughness():
    slope = 0.1 * np.arange(500.0)
    assert realised_class(np.vstack([slope, -slope]), 0.2).roughness == "flat"


@pytest.mark.parametrize("profiles", [np.zeros(9), np.full(900, np.nan), np.zeros((2, 2, 2)), np.zeros(3)])
def test_too_little_or_broken_profiles_are_refused(profiles):
    with pytest.raises(SimulationError, match="profiles"):
        realised_class(profiles, 0.3)
