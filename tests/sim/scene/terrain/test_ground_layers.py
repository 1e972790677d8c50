"""Layers that stand in a place, against closed forms written down here once more."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from scenarios import spec
from sim.scene.roads import Road
from sim.scene.terrain import build_terrain

SEED = np.random.SeedSequence(4)
AREA = (-40.0, -40.0, 40.0, 40.0)
CELL = 0.25
NARROW = {"cell": CELL, "shoulder": 1.0}


@pytest.fixture(autouse=True)
def _no_cache(monkeypatch):
    monkeypatch.setenv("DATMO_CACHE_DIR", "off")


def built(*layers, area=AREA, roads=(), seed=SEED, **changes):
    return build_terrain(spec.Terrain(layers=layers, **{**NARROW, **changes}), roads, area, seed)


def at(terrain, *places):
    return terrain.height_at(np.array(places, float))


def placed(origin, heading_deg, s, t):
    """The world place s along and t to the left of a heading."""
    c, n = math.cos(math.radians(heading_deg)), math.sin(math.radians(heading_deg))
    return origin[0] + s * c - t * n, origin[1] + s * n + t * c


def grid_error(second_derivative):
    """What linear interpolation over a cell may be off by, with some room."""
    return 0.6 * CELL**2 * second_derivative + 1e-6


@pytest.mark.parametrize("heading", [0.0, 90.0, 37.0, -120.0])
def test_a_crest_is_a_half_wave_of_cosine_squared(heading):
    terrain = built({"kind": "crest", "at": [3, -2], "heading_deg": heading, "height": 2, "length": 30})
    for s, share in ((0, 1), (7.5, 0.5), (-7.5, 0.5), (5, math.cos(math.pi / 6) ** 2), (15, 0), (22, 0)):
        for t in (0, 9, -13):
            (z,) = at(terrain, placed((3, -2), heading, s, t))
            assert z == pytest.approx(2 * share, abs=grid_error(2 * 2 * math.pi**2 / 30**2))


def test_a_dip_is_a_crest_upside_down_and_width_ends_it():
    shape = {"at": [0, 0], "heading_deg": 20, "length": 24, "width": 16}
    up, down = built({"kind": "crest", "height": 1.5, **shape}), built({"kind": "dip", "depth": 1.5, **shape})
    assert np.array_equal(up.height, -down.height)
    (z,) = at(up, placed((0, 0), 20, 6, 4))
    assert z == pytest.approx(1.5 * 0.5 * 0.5, abs=0.01)
    assert at(up, placed((0, 0), 20, 0, 8.3))[0] == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("height", [3.0, -1.0])
def test_a_hill_is_a_gaussian(height):
    terrain = built({"kind": "hill", "at": [5, 5], "height": height, "radius": 6})
    for r in (0, 3, 6, 12, 30):
        (z,) = at(terrain, (5 - r, 5))
        assert z == pytest.approx(height * math.exp(-(r**2) / 72), abs=1e-6)


def test_a_ramp_rises_along_its_heading_carries_a_top_and_comes_down():
    ramp = {"kind": "ramp", "at": [0, -20], "rise": 2, "length": 10, "plateau": 5, "width": 8}
    places = [(0, -21), (0, -15), (3.75, -10), (0, -7), (0, 0), (0, 6), (5, -7), (-5, -7)]
    assert at(built(ramp), *places) == pytest.approx([0, 1, 2, 2, 1, 0, 0, 0], abs=1e-6)
    endless = built({**ramp, "plateau": None, "width": None})
    assert at(endless, (-39, 39), (39, -15), (0, -30)) == pytest.approx([2, 1, 0], abs=1e-6)


def test_a_step_rises_within_one_cell():
    terrain = built({"kind": "step", "at": [10, 0], "heading_deg": 0, "rise": 0.3, "plateau": 4, "width": 6})
    places = [(10, 0), (10 + CELL, 0), (14, 2.5), (14 + 2 * CELL, 0), (12, 3.5)]
    assert at(terrain, *places) == pytest.approx([0, 0.3, 0.3, 0, 0], abs=1e-6)


def test_washboard_is_a_sine_that_fades_in():
    layer = {
        "kind": "washboard",
        "at": [0, 0],
        "length": 12,
        "wavelength": 1.5,
        "amplitude": 0.03,
        "width": 3,
    }
    terrain = built(layer, cell=0.125, area=(-5, -5, 5, 15))
    for s, share in ((0.375, 0.25), (1.875, 1), (2.625, -1), (4.875, 1), (11.625, -0.25), (12.5, 0)):
        assert at(terrain, (0, s)) == pytest.approx([0.03 * share], abs=1e-6)
    assert at(terrain, (2, 1.875)) == [0]


def circular(s):
    R = (3.7**2 / 4 + 0.1**2) / 0.2  # the circle through both feet and the top
    return math.sqrt(R**2 - s**2) - R + 0.1


@pytest.mark.parametrize(
    ("profile", "form"),
    [
        ("circular", circular),
        ("sinusoidal", lambda s: 0.05 * (1 + math.cos(2 * math.pi * s / 3.7))),
        ("flat_top", lambda s: 0.1 * min(1, (1.85 - abs(s)) / 1.5)),
    ],
)
def test_speed_bumps_have_their_published_sections(profile, form):
    layer = {"kind": "speed_bump", "at": [1, 2], "profile": profile, "ramp": 1.5, "width": 6}
    terrain = built(layer, cell=0.125, area=(-10, -10, 10, 10))
    for s in (-1.75, -1, 0, 0.5, 1.25):
        assert at(terrain, (1, 2 + s), (3.5, 2 + s)) == pytest.approx([form(s)] * 2, abs=2e-6)
    assert at(terrain, (1, 4), (4.25, 2), (1, -1)) == pytest.approx([0, 0, 0])


def test_a_pothole_is_a_bowl():
    terrain = built({"kind": "pothole", "at": [2, 2], "depth": 0.08, "radius": 1.0})
    assert at(terrain, (2, 2), (2.5, 2), (2, 3), (3.25, 2)) == pytest.approx(
        [-0.08, -0.08 * 0.75**2, 0, 0], abs=1e-6
    )


MANY = [
    {"kind": "crest", "at": [0, 10], "height": 1, "length": 20},
    {"kind": "hills", "density": 30},
    {"kind": "potholes", "on": "all"},
    {"kind": "kerb"},
    {"kind": "ditch", "offset": 5.0},
    {"kind": "bank"},
    {"kind": "speed_bump", "at": [0, 0]},
]
ROADS = [Road(np.column_stack([20 * np.cos(a := np.linspace(0, 3, 90)), 20 * np.sin(a)]), 8.0)]


def test_layers_add_up_each_as_if_alone():
    bare = {"roads": ROADS, "area": (-30, -30, 30, 30)}
    base = built(**bare)
    whole = built(*MANY, grade=0.05, **bare).height
    alone = (
        sum(built(layer, **bare).height - base.height for layer in MANY) + built(grade=0.05, **bare).height
    )
    assert np.abs(whole - alone).max() < 1e-5


@pytest.mark.long
@settings(max_examples=4, deadline=None)
@given(order=st.permutations(range(len(MANY))))
def test_their_order_is_of_no_account(order):
    bare = {"roads": ROADS, "area": (-30, -30, 30, 30), "cell": 0.3, "roughness": "C"}
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DATMO_CACHE_DIR", "off")
        one, other = built(*MANY, **bare), built(*(MANY[i] for i in order), **bare)
    assert np.abs(one.height - other.height).max() < 1e-5
    assert np.array_equal(one.kind, other.kind)


@pytest.mark.parametrize(
    "layer", [{"kind": "hills", "density": 20}, {"kind": "potholes", "on": "all", "density": 300}]
)
def test_what_is_strewn_lies_still_when_the_area_grows(layer):
    small, large = built(layer, area=(-20, -10, 20, 15)), built(layer, area=(-150, -50, 140, 60))
    xy = np.random.default_rng(0).uniform((-20, -10), (20, 15), (500, 2))
    assert small.height_at(xy) == pytest.approx(large.height_at(xy), abs=2e-3)
    assert small.height.std() > 1e-3
    other = built(layer, area=(-20, -10, 20, 15), seed=np.random.SeedSequence(5))
    assert not np.array_equal(other.height, small.height)


@pytest.mark.long
def test_one_layer_more_leaves_the_luck_of_the_others():
    rough = {"roughness": "E", "area": (-15, -15, 15, 15)}
    hills = {"kind": "hills", "density": 30}
    with_hills, bare = built(hills, **rough), built(**rough)
    both = built({"kind": "potholes", "on": "all"}, hills, **rough)
    alone = built({"kind": "potholes", "on": "all"}, **rough)
    assert np.abs((both.height - alone.height) - (with_hills.height - bare.height)).max() < 1e-5
    twice = built(hills, hills, **rough)
    assert np.abs(twice.height - 2 * with_hills.height + bare.height).max() > 0.05


def test_potholes_keep_to_where_they_belong():
    road = Road(np.array([[-60.0, 0.0], [60.0, 0.0]]), 12.0)
    for on, inside in (("road", True), ("field", False)):
        terrain = built({"kind": "potholes", "on": on, "density": 900}, roads=[road])
        j, _ = np.nonzero(terrain.height < -0.02)
        y = np.abs(terrain.y0 + terrain.cell * j)
        assert len(y) > 20
        assert y.max() < 6 + 1 if inside else y.min() > 6 - 1


@pytest.mark.parametrize(
    ("layer", "match"),
    [
        (
            {"kind": "washboard", "at": [0, 0], "length": 9, "wavelength": 0.8},
            "wavelength 0.8 m is under 4 cells",
        ),
        ({"kind": "pothole", "at": [0, 0], "radius": 0.4}, "radius 0.4 m is under 2 cells"),
        ({"kind": "speed_bump", "at": [0, 0], "length": 0.9}, "length 0.9 m is under 4 cells"),
        ({"kind": "ditch", "width": 0.9, "bottom": 0.1}, "width 0.9 m is under 4 cells"),
        ({"kind": "hills", "radius": [0.5, 3]}, "radius 0.5 m is under 2 cells"),
        (
            {"kind": "crest", "at": [0, 0], "height": 1, "length": 9, "width": 1},
            "width 1.0 m is under 4 cells",
        ),
        ({"kind": "ditch", "width": 2, "bottom": 2}, "not under the width"),
        ({"kind": "speed_bump", "at": [0, 0], "profile": "flat_top", "length": 3}, "two ramps"),
        ({"kind": "hills", "radius": [9, 3]}, "low, high"),
        ({"kind": "potholes", "depth": [0, 3]}, "low, high"),
        ({"kind": "bump", "at": [0, 0]}, "speed_bump"),
    ],
)
def test_impossible_layers_are_refused(layer, match):
    with pytest.raises(ValidationError, match=match):
        spec.Terrain(cell=0.3, layers=[layer])


def test_what_holds_for_all_roads_is_said_once():
    with pytest.raises(ValidationError, match="kerb is there twice"):
        spec.Terrain(layers=[{"kind": "kerb"}, {"kind": "kerb"}])
