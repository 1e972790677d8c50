"""How bright surfaces are at the angles at which they are seen."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from datmo.messages import Kind
from sim.scan.merge import NOTHING, TERRAIN, THING
from sim.scan.surface import LEVEL, REFLECTIVITY, ROUGH, surfaces


def met(winner: int, cosine: np.ndarray, kind: Kind, rho: float = 0.4) -> SimpleNamespace:
    """What rays at some angles meet on one surface: the ground, a thing or an actor."""
    m = len(cosine)
    hits = SimpleNamespace(
        winner=np.full(m, winner, np.int32),
        triangle=np.zeros(m, np.int32),
        cosine=cosine.astype(np.float32),
    )
    one = np.full(1, rho, np.float32)
    things = SimpleNamespace(thing=np.full(1, 7, np.int32), kind=np.full(1, kind, np.uint8), reflectivity=one)
    body = SimpleNamespace(reflectivity=one)
    return surfaces(hits, np.full(1, kind, np.uint8), things, [body], np.full(1, kind, np.uint8))


def test_rough_ground_keeps_its_brightness_at_grazing_angles() -> None:
    """Oren and Nayar's cos t + (B / A) sin² t."""
    angle = np.radians([0.0, 30.0, 60.0, 83.0, 88.0])
    got = met(TERRAIN, np.cos(angle), Kind.ROAD)
    kept = np.cos(angle) + ROUGH * np.sin(angle) ** 2
    np.testing.assert_allclose(got.reflectance, REFLECTIVITY[Kind.ROAD] * kept, rtol=1e-5)
    np.testing.assert_allclose(got.level, LEVEL[Kind.ROAD] * kept, rtol=1e-5)
    assert kept[3] == pytest.approx(0.78, abs=0.01)
    assert (got.thing == -1).all()


def test_paint_goes_dark_at_grazing_angles() -> None:
    """Against Fresnel's equations for a coat of n = 1.5, passed on the way in and out."""
    angle = np.radians(np.linspace(0, 85, 18))
    inside = np.arcsin(np.sin(angle) / 1.5)
    c, t = np.cos(angle), np.cos(inside)
    mirrored = (((c - 1.5 * t) / (c + 1.5 * t)) ** 2 + ((t - 1.5 * c) / (t + 1.5 * c)) ** 2) / 2
    exact = c * ((1 - mirrored) / (1 - mirrored[0])) ** 2
    got = met(0, c, Kind.CAR, rho=0.4)
    np.testing.assert_allclose(got.reflectance / 0.4, exact, atol=0.025)  # Schlick's form is near
    np.testing.assert_allclose(got.level, got.reflectance, rtol=1e-5)
    assert got.reflectance[-1] < 0.03 * got.reflectance[0]


def test_a_thing_has_its_own_reflectivity_and_id() -> None:
    got = met(THING, np.ones(3), Kind.SIGN, rho=0.95)
    np.testing.assert_allclose(got.reflectance, 0.95, rtol=1e-6)
    assert (got.thing == 7).all()
    assert (got.kind == Kind.SIGN).all()


def test_nothing_is_dark() -> None:
    got = met(NOTHING, np.zeros(3), Kind.CAR)
    assert not got.kind.any()
    assert not got.reflectance.any()
    assert (got.thing == -1).all()
