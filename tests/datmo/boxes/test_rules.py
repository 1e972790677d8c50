"""The rule filter."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.boxes.config import FilterConfig
from datmo.boxes.rules import apply_rules

ENOUGH = 60


def judge(size, points=ENOUGH, clearance=0.3, **limits):
    kept, rejections = apply_rules(
        np.array([size], float), np.array([points]), np.array([clearance]), FilterConfig(**limits)
    )
    assert bool(kept[0]) == (not rejections)
    return rejections[0] if rejections else None


@pytest.mark.parametrize(
    ("size", "points"),
    [
        ((4.4, 1.8, 1.5), 200),
        ((1.7, 0.0, 1.5), 12),  # the rear of a car alone
        ((16.5, 2.6, 4.0), 90),
        ((12.0, 1.0, 3.5), 90),
        ((0.5, 0.3, 1.7), 10),
        ((0.3, 0.1, 0.9), 5),
        ((3.9, 1.7, 0.6), 8),
    ],
)
def test_road_users_and_their_parts_pass(size, points):
    assert judge(size, points) is None


@pytest.mark.parametrize(
    ("rule", "size", "points", "limit"),
    [
        ("points", (4.4, 1.8, 1.5), 4, 5),
        ("length", (25, 2, 3), ENOUGH, 17),
        ("length", (0.05, 0.05, 1), ENOUGH, 0.15),
        ("width", (8, 5, 3), ENOUGH, 3.5),
        ("height", (4, 2, 0.3), ENOUGH, 0.5),
        ("height", (4, 2, 6), ENOUGH, 4.5),
        ("volume", (16.5, 3, 4), ENOUGH, 180),
        ("area", (16.5, 3.4, 1), ENOUGH, 50),
        ("ratio", (12, 0.3, 2), ENOUGH, 15),
        ("slender height", (0.4, 0.3, 3), ENOUGH, 2.5),
        ("density", (10, 2.5, 3), 6, 0.3),
    ],
)
def test_each_rule_names_itself_its_value_and_its_limit(rule, size, points, limit):
    rejection = judge(size, points)
    assert (rejection.rule, rejection.limit) == (rule, limit)
    value = {
        "points": points,
        "length": size[0],
        "width": size[1],
        "height": size[2],
        "slender height": size[2],
        "volume": np.prod(size),
        "area": size[0] * size[1],
        "ratio": size[0] / size[1],
        "density": points / np.prod(size),
    }[rule]
    assert rejection.value == pytest.approx(value)
    assert f"{rule} {value:.4g}" in str(rejection)


def test_what_floats_is_refused_and_what_an_occluder_left_is_not():
    rejection = judge((2.0, 1.5, 2.9), clearance=2.4)
    assert (rejection.rule, rejection.value, rejection.limit) == ("clearance", 2.4, 1.8)
    assert judge((0.5, 0.4, 1.75), clearance=1.4) is None  # head and shoulders behind a car
    assert judge((8.0, 2.5, 3.8), clearance=1.6) is None  # a lorry behind it


def test_the_ratio_is_checked_only_above_its_length():
    assert judge((8.9, 0.1, 2)) is None
    assert judge((9.1, 0.1, 2)).rule == "ratio"
    assert judge((9.1, 0.1, 2), ratio_above=10) is None


def test_a_volume_of_nothing_is_dense():
    assert judge((1.7, 0, 1), 5, density=100) is None


def test_every_box_is_kept_or_named_once():
    rng = np.random.default_rng(0)
    size = np.sort(rng.uniform(0, 8, (200, 2)))[:, ::-1]
    size = np.column_stack([size, rng.uniform(0, 6, 200)])
    kept, rejections = apply_rules(size, rng.integers(1, 40, 200), rng.uniform(0, 3, 200), FilterConfig())
    assert sorted([*np.flatnonzero(kept), *(r.cluster for r in rejections)]) == list(range(200))
    assert 20 < kept.sum() < 180
    assert [r.cluster for r in rejections] == sorted(r.cluster for r in rejections)
