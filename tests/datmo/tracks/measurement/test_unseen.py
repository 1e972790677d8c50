"""Not being seen, against a brute-force Bayes rule on a grid of places."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.messages import Boxes, Sight
from datmo.messages.sight import AZIMUTH_STEP, ELEVATION_STEP, HIGHEST, LOWEST
from datmo.tracks import Tracker, TrackerConfig
from datmo.tracks.bank import Bank
from datmo.tracks.measurement.unseen import FOUND, hold_back

SHAPE = (round((HIGHEST - LOWEST) / ELEVATION_STEP), round(2 * np.pi / AZIMUTH_STEP))


def wall(low: float, high: float, at: float = 8.0, beyond: float = 60.0) -> Sight:
    """A wall along y at x = `at`, from y = `low` to `high`, and nothing else until `beyond`."""
    azimuth = -np.pi + (np.arange(SHAPE[1]) + 0.5) * AZIMUTH_STEP
    y = at * np.tan(azimuth)
    hit = (np.abs(azimuth) < np.pi / 2) & (y > low) & (y < high)
    reach = np.where(hit, at / np.maximum(np.cos(azimuth), 1e-3), beyond)
    image = np.tile(reach, (SHAPE[0], 1))
    return Sight(near=image, far=image, T_world_sensor=np.eye(4))


def bank_of(y: float, speed: float, P: np.ndarray) -> Bank:
    """One car of one mode on its way along y at x = 16."""
    bank = Bank.empty(1, 5)
    one = {name: np.zeros((1, *getattr(bank, name).shape[1:])) for name in bank.__dataclass_fields__}
    one |= {"x": np.array([[[16.0, y, np.pi / 2, speed, 0.0]]]), "P": P[None, None], "mu": np.ones((1, 1))}
    one |= {"size": np.array([[4.5, 1.8, 1.5]]), "yaw": np.array([np.pi / 2])}
    return Bank(**one)


def covariance(std: float, speed_std: float, correlation: float) -> np.ndarray:
    P = np.diag([0.04, std**2, 0.01, speed_std**2, 0.01])
    P[1, 3] = P[3, 1] = correlation * std * speed_std
    return P


@pytest.mark.parametrize("y", [-2.0, 0.0, 3.0, 5.0])
def test_the_place_is_that_of_bayes_rule(y):
    P = covariance(2.0, 1.0, 0.8)
    bank, sight = bank_of(y, 5.0, P), wall(-4.0, 4.0)
    hold_back(bank, np.ones(1, bool), bank.x[:, 0], P[None], np.zeros((1, 2)), sight)
    # 16 m away the wall of 8 m hides 16 m; what of a car of 4.5 m pokes out is seen
    place = y + np.linspace(-6, 6, 2401)
    out = np.clip((np.abs(place) + 2.25 * 0.7 - 8.0) / (2 * 2.25 * 0.7), 0, 1)
    weight = np.exp(-0.5 * ((place - y) / 2.0) ** 2) * (1 - FOUND * out)
    weight /= weight.sum()
    mean = weight @ place
    assert bank.x[0, 0, 1] == pytest.approx(mean, abs=0.35)
    assert np.sqrt(bank.P[0, 0, 1, 1]) == pytest.approx(np.sqrt(weight @ (place - mean) ** 2), abs=0.35)
    # the speed follows by regression on the place
    assert bank.x[0, 0, 3] - 5.0 == pytest.approx(0.8 * 0.5 * (bank.x[0, 0, 1] - y), abs=1e-9)
    assert (np.linalg.eigvalsh(bank.P[0, 0]) > 0).all()


def test_wholly_hidden_and_wholly_seen_places_are_no_news():
    P = covariance(0.5, 1.0, 0.8)
    for y in (0.0, 20.0):
        bank = bank_of(y, 5.0, P)
        before = bank.x.copy()
        hold_back(bank, np.ones(1, bool), bank.x[:, 0], P[None], np.zeros((1, 2)), wall(-4.0, 4.0))
        np.testing.assert_allclose(bank.x, before, atol=0.05)
    bank = bank_of(7.0, 5.0, covariance(2.0, 1.0, 0.8))
    before = bank.x.copy()
    hold_back(bank, np.zeros(1, bool), bank.x[:, 0], bank.P[:, 0], np.zeros((1, 2)), wall(-4.0, 4.0))
    np.testing.assert_array_equal(bank.x, before)


@pytest.mark.parametrize(("hold", "kept"), [(True, True), (False, False)])
def test_a_car_that_stops_behind_a_wall_is_waited_for(hold, kept):
    tracker, sight = Tracker(TrackerConfig(hold_back=hold)), wall(-4.0, 4.0)
    y, alive = -18.0, set()
    for k in range(55):
        y += 0.1 * float(np.clip(2.5 * np.sqrt(max(0.0 - y, 0)), 0, 6.0))  # stands at y = 0
        seen = Boxes([[16.0, y, 0.0]], [[4.5, 1.8, 1.5]], [np.pi / 2])
        boxes = seen if y < -7 else Boxes.empty()
        tracks = tracker.step(boxes, 0.1 * k, sight)
        alive = set(tracks.boxes.id[tracks.confirmed()].tolist())
    assert bool(alive) is kept
    if kept:
        assert abs(tracks.boxes.center[0, 1]) < 8.5
