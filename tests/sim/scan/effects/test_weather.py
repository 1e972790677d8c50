from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from datmo.messages import FalseReturn
from scenarios.spec import IDEAL, Noise, Weather
from sim.scan.effects.air import (
    APERTURE,
    DIVERGENCE,
    DROP,
    STEP,
    air,
    density,
    extinction,
    overlap,
)
from sim.scan.effects.weather import add_weather
from sim.scan.luck import Luck
from sim.scan.returns import FADE, FAINTEST, Lasers, Returns, measure

LIMITS = (0.9, 80.0)
M = 40_000
EVEN = Lasers(np.zeros(64, np.float32), np.ones(64, np.float32), np.zeros(64, np.float32))
"""Lasers that answer alike."""


def rays(distance: float, rho: float = 0.3, m: int = M) -> tuple[SimpleNamespace, SimpleNamespace]:
    hits = SimpleNamespace(distance=np.full(m, distance, np.float32))
    met = SimpleNamespace(reflectance=np.full(m, rho, np.float32), level=np.full(m, 0.3, np.float32))
    return hits, met


def sweep(distance: float, weather: Weather, rho: float = 0.3, noise: Noise = IDEAL) -> Returns:
    hits, met = rays(distance, rho)
    here, luck = air(weather, LIMITS[1]), Luck(np.random.SeedSequence(4))
    returns = measure(hits, met, noise, here.alpha, LIMITS, EVEN, luck)
    if not here.clear:
        add_weather(hits, met, np.zeros(M, bool), returns, here, LIMITS, luck)
    return returns


def test_extinction_is_that_of_the_sources() -> None:
    """25 mm/h take 9.3 dB/km, 2.5 mm/h of dry snow 19.6 dB/km (ITU-R P.1814); V leaves 5 %."""
    decibel = 10 * np.log10(np.exp(1)) * 1000
    assert extinction(Weather(rain_mm_h=25)) * decibel == pytest.approx(9.30, abs=0.01)
    assert extinction(Weather(snow_mm_h=2.5)) * decibel == pytest.approx(19.64, abs=0.01)
    assert np.exp(-extinction(Weather(fog_visibility_m=120)) * 120) == pytest.approx(0.05)
    assert extinction(Weather()) == 0
    both = Weather(rain_mm_h=4, fog_visibility_m=300)
    assert extinction(both) == pytest.approx(
        extinction(Weather(rain_mm_h=4)) + extinction(Weather(fog_visibility_m=300))
    )


def test_seen_drops_are_those_of_a_brute_force_rain() -> None:
    """Draw the drops of a metre of beam at 8 m from Marshall and Palmer, and count the bright ones."""
    rng, rate, r, power = np.random.default_rng(1), 30.0, 8.0, 3e-6
    slope, alpha = 4.1 * rate**-0.21, extinction(Weather(rain_mm_h=rate))
    beam = APERTURE + DIVERGENCE * r
    volume = np.pi / 4 * beam**2 * 1e5  # of so many metres, to see enough of them
    diameter = rng.exponential(1 / slope, rng.poisson(8000 / slope * volume)) * 1e-3
    echo = DROP * (diameter / beam) ** 2 * overlap(np.array(r)) / r**2 * np.exp(-2 * alpha * r)
    want = (echo > power).sum() / 1e5
    got = density(np.array(r), np.array(power), alpha, 8000.0, slope, DROP, 1.0)
    assert want * 1e5 > 100
    assert got == pytest.approx(want, rel=4 / np.sqrt(want * 1e5))


def test_drops_come_as_often_and_from_where_the_rain_says() -> None:
    """Rays into the sky: a Poisson process along each."""
    weather = Weather(rain_mm_h=150)
    returns, table = sweep(np.inf, weather), air(weather, LIMITS[1])
    row = int(np.ceil(48 * np.log(FAINTEST / 1e-7) / np.log(1e6)))
    total = table.rain[row, -1]
    assert 0.002 < total < 3
    share = returns.hit.mean()
    assert share == pytest.approx(1 - np.exp(-total), abs=4 * np.sqrt(share / M))
    assert set(np.unique(returns.false)) == {0, FalseReturn.RAIN}
    assert (returns.hit == (returns.false > 0)).all()

    def law(r: np.ndarray) -> np.ndarray:
        return (1 - np.exp(-np.interp(r, table.r, table.rain[row]))) / (1 - np.exp(-total))

    assert np.abs(stats.ecdf(returns.distance[returns.hit]).cdf.evaluate(table.r) - law(table.r)).max() < 0.03


def test_a_bright_wall_hides_the_rain_and_a_dark_one_does_not() -> None:
    heavy = Weather(snow_mm_h=3)
    near, far = sweep(3.0, heavy), sweep(60.0, heavy, rho=0.05)
    assert (near.false > 0).mean() < 0.01
    assert (far.false > 0).mean() > 0.3
    assert (near.distance[near.false == 0] == 3.0).all()
    assert far.distance[far.false > 0].max() < 60.0


def test_fog_is_seen_against_the_sky_where_its_echo_comes_from() -> None:
    weather = Weather(fog_visibility_m=40)
    returns, table = sweep(np.inf, weather), air(weather, LIMITS[1])
    assert returns.hit.mean() > 0.85
    assert (returns.false[returns.hit] == FalseReturn.FOG).all()
    cdf = table.fog_up_to / table.fog_up_to[-1]
    seen = stats.ecdf(returns.distance[returns.hit]).cdf.evaluate(table.r)
    assert np.abs(seen - cdf).max() < 0.04


def test_thick_air_loses_what_the_link_budget_says() -> None:
    """Share lost = 1 / (1 + (P / P0)^FADE) with P = rho / R² exp(-2 alpha R)."""
    weather, R, rho = Weather(fog_visibility_m=60), 20.0, 0.07
    returns = sweep(R, weather, rho, IDEAL.model_copy(update={"grazing": True}))
    power = rho / R**2 * np.exp(-2 * extinction(weather) * R)
    kept = 1 / (1 + (FAINTEST / power) ** FADE)
    hits, met = rays(R, rho)
    alone = measure(hits, met, IDEAL.model_copy(update={"grazing": True}), extinction(weather), LIMITS, EVEN,
                    Luck(np.random.SeedSequence(4)))  # fmt: skip
    assert 0.1 < kept < 0.95
    assert alone.hit.mean() == pytest.approx(kept, abs=0.01)
    assert (returns.hit & (returns.false == 0)).mean() <= alone.hit.mean()


def test_nothing_is_seen_through_the_own_body() -> None:
    hits, met = rays(np.inf)
    luck, here = Luck(np.random.SeedSequence(4)), air(Weather(snow_mm_h=5), LIMITS[1])
    returns = measure(hits, met, IDEAL, here.alpha, LIMITS, EVEN, luck)
    add_weather(hits, met, np.ones(M, bool), returns, here, LIMITS, luck)
    assert not returns.hit.any()


def test_clear_air_has_no_tables_to_speak_of() -> None:
    here = air(Weather(), 80.0)
    assert here.clear
    assert not here.rain.any()
    assert not here.snow.any()
    assert not here.fog.any()
    assert here.r[1] - here.r[0] == STEP
