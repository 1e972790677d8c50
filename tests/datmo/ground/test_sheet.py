"""The coarse sheet: robust, on hills, and what it tells of how the ground bends."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.bins import bin_edges
from datmo.ground import GroundConfig
from datmo.ground.grid import PolarGrid
from datmo.ground.lattice import corners, prior
from datmo.ground.sheet import Sheet, coarse_lattice, flat_sheet, learned_bend, settle

GRID = PolarGrid(180, bin_edges())
LATTICE = coarse_lattice(GRID.segments, GRID.centers)
CONFIG = GroundConfig()


def drawn(azimuth: np.ndarray, radius: np.ndarray, z: np.ndarray, weight: np.ndarray) -> Sheet:
    """A first sheet and a later one through these points."""
    noise = CONFIG.coarse_noise
    p = prior(LATTICE, CONFIG.coarse_bend, CONFIG.coarse_slope, 3.0, noise)
    places = corners(azimuth, radius, LATTICE.lines, GRID.segments, LATTICE.radii)
    sheet = settle(flat_sheet(LATTICE), z, weight, places, p, noise, True, True)
    return settle(sheet, z, weight, places, p, noise, True, False)


def polar(xy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    azimuth = np.arctan2(xy[:, 1], xy[:, 0]) / (2 * np.pi) % 1.0 * GRID.segments
    return azimuth, np.hypot(xy[:, 0], xy[:, 1])


def test_sheet_passes_under_scattered_obstacles_and_follows_hills() -> None:
    """What covers the ground as a car does is kept out of it by `seeds`."""
    rng = np.random.default_rng(2)
    xy = rng.uniform(-50, 50, (8000, 2))
    hill = 0.8 * np.sin(xy[:, 0] / 8)
    z = hill + rng.normal(0, 0.03, 8000)
    up = rng.random(8000) < 0.1
    z[up] += rng.uniform(0.3, 3, up.sum())
    sheet = drawn(*polar(xy), z, np.ones(8000))
    inner = (np.abs(xy) < 45).all(1)
    assert np.sqrt(np.mean((sheet.at(*polar(xy), GRID.segments) - hill)[inner] ** 2)) < 0.05


def test_points_of_no_weight_are_as_if_absent() -> None:
    rng = np.random.default_rng(3)
    azimuth, radius = rng.uniform(0, 180, 2000), rng.uniform(3, 60, 2000)
    z, weight = rng.normal(0, 0.2, 2000), (rng.random(2000) < 0.7).astype(float)
    z[weight == 0] = 50.0
    some = weight > 0
    want = drawn(azimuth[some], radius[some], z[some], weight[some])
    assert np.array_equal(drawn(azimuth, radius, z, weight).f, want.f)


def test_a_later_sheet_forgets_what_bore_on_it_and_no_longer_does() -> None:
    """Nodes without points start level, not where a wall left them."""
    rng = np.random.default_rng(4)
    azimuth, radius = rng.uniform(0, 180, 4000), rng.uniform(3, 60, 4000)
    wall = (azimuth < 30) & (radius > 20)
    z = np.where(wall, 2.0, 0.0)
    noise = CONFIG.coarse_noise
    p = prior(LATTICE, CONFIG.coarse_bend, CONFIG.coarse_slope, 3.0, noise)
    places = corners(azimuth, radius, LATTICE.lines, GRID.segments, LATTICE.radii)
    first = settle(flat_sheet(LATTICE), z, np.ones(4000), places, p, noise, True, True)
    later = settle(first, z, (~wall).astype(float), places, p, noise, True, False)
    middle = np.array([15.0]), np.array([40.0])
    assert first.at(*middle, GRID.segments)[0] > 1.0
    assert abs(later.at(*middle, GRID.segments)[0]) < 0.3


def test_the_lattice_has_a_third_of_the_lines_and_radii() -> None:
    lattice = coarse_lattice(100, np.arange(1.0, 12.0))
    assert lattice.lines == 34
    assert len(lattice.radii) == 4
    assert lattice.radii[0] == pytest.approx(2.0)
    assert (np.diff(lattice.radii) > 0).all()


def test_learned_bend_of_a_bowl() -> None:
    """f = κ r² / 2 turns its slope by κ h from one node to the next, and leans by κ r / 2."""
    r, kappa = LATTICE.radii, 0.03
    sheet = Sheet(LATTICE, np.tile(kappa * r**2 / 2, (LATTICE.lines, 1)))
    near = r[2:] < 50
    steps = ((r[2:] - r[:-2]) / 2)[near]
    got = learned_bend(sheet, np.ones(GRID.shape, bool), 50.0)
    lean = np.quantile(kappa * r[(r >= 20) & (r < 50)] / 2, 0.9)
    assert got == pytest.approx((kappa * np.median(steps) / 0.6745, lean), rel=1e-6)


def test_learned_bend_of_random_kinks_is_their_deviation() -> None:
    rng = np.random.default_rng(5)
    r, tau = LATTICE.radii, 0.07
    slopes = np.cumsum(rng.normal(0, tau, (LATTICE.lines, len(r) - 1)), 1)
    f = np.concatenate([np.zeros((LATTICE.lines, 1)), np.cumsum(slopes * np.diff(r), 1)], 1)
    seen = np.ones(GRID.shape, bool)
    assert learned_bend(Sheet(LATTICE, f), seen, 50.0)[0] == pytest.approx(tau, rel=0.06)
    f[:, LATTICE.radii > 40] += rng.normal(0, 9, f[:, LATTICE.radii > 40].shape)
    seen[:, GRID.centers > 35] = False  # what is not seen does not tell
    assert learned_bend(Sheet(LATTICE, f), seen, 50.0)[0] == pytest.approx(tau, rel=0.06)


def test_learned_bend_of_too_few_places_is_none() -> None:
    f = np.random.default_rng(6).normal(size=(LATTICE.lines, len(LATTICE.radii)))
    seen = np.zeros(GRID.shape, bool)
    seen[0:3, 0:30] = True  # one line of ten nodes: eight bends
    assert learned_bend(Sheet(LATTICE, f), seen, 50.0) == (0.0, 0.0)
    seen[3:6, 0:30] = True
    assert learned_bend(Sheet(LATTICE, f), seen, 50.0)[0] > 0.0
