"""Kerbs, sidewalks, ditches and banks: what follows the roads."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.messages import Kind
from scenarios import spec
from sim.scene.carriageways import carriageways, offsets
from sim.scene.roads import Road
from sim.scene.terrain import build_terrain

SEED = np.random.SeedSequence(4)
CELL = 0.25
EAST, NORTH = (
    Road(np.array([[-60.0, 0.0], [60.0, 0.0]]), 8.0),
    Road(np.array([[0.0, -60.0], [0.0, 60.0]]), 6.0),
)


@pytest.fixture(autouse=True)
def _no_cache(monkeypatch):
    monkeypatch.setenv("DATMO_CACHE_DIR", "off")


def built(*layers, roads=(EAST, NORTH), area=(-30.0, -30.0, 30.0, 30.0), **changes):
    terrain = spec.Terrain(layers=layers, **{"cell": CELL, **changes})
    return build_terrain(terrain, roads, area, SEED)


def at(terrain, *places):
    return terrain.height_at(np.array(places, float))


def test_a_kerb_stands_at_the_edge_with_a_sidewalk_behind_and_the_field_comes_up_to_it():
    terrain = built({"kind": "kerb", "height": 0.15, "sidewalk": 2.0, "verge": 1.0})
    edge = 4.1  # half of the road and the gutter
    places = [(20, 0), (20, 4.0), (20, 4.5), (20, 6.0), (20, edge + 2.5), (20, 7.5), (20, 20)]
    assert at(terrain, *places) == pytest.approx([0, 0, 0.15, 0.15, 0.075, 0, 0], abs=0.012)
    kinds = terrain.kind_at(np.array([(20, 3.8), (20, 5.0), (20, 5.9), (20, 6.6), (-20, -5.0)]))
    assert kinds.tolist() == [Kind.ROAD, Kind.SIDEWALK, Kind.SIDEWALK, Kind.FIELD, Kind.SIDEWALK]


def test_crossing_roads_stay_clear_of_kerbs():
    terrain = built({"kind": "kerb"})
    along = np.linspace(-29, 29, 400)
    for across in np.linspace(-3.9, 3.9, 9):
        assert not at(terrain, *np.column_stack([along, np.full(400, across)])).any()
    for across in np.linspace(-2.9, 2.9, 9):
        assert not at(terrain, *np.column_stack([np.full(400, across), along])).any()
    assert at(terrain, (4.5, 5.5)) == pytest.approx([0.125], abs=1e-6)  # the corner between them


def test_seams_between_lanes_and_small_islands_are_no_edges():
    lanes = [Road(np.array([[-60.0, y], [60.0, y]]), 3.9) for y in (-2.0, 2.0)]
    around = [Road(np.array([[x - 4.0, -20.0], [x - 4.0, 20.0]]), 4.0) for x in (0.0, 9.0)]
    terrain = built({"kind": "kerb"}, roads=[*lanes, *around, Road(np.array([[-9.0, 8.0], [9.0, 8.0]]), 4.0)])
    assert not at(terrain, *[(x, 0.0) for x in np.linspace(-29, 29, 100)]).any()
    assert at(terrain, (0.5, 5.0)) == [0]  # enclosed by four lanes, 5 m by 2 m
    assert terrain.kind_at(np.array([[0.5, 5.0]])) == Kind.ROAD


def test_the_sidewalk_is_as_smooth_as_the_road():
    kerbed = built({"kind": "kerb", "sidewalk": 3.0}, roughness="F", road_roughness="flat")
    on = np.column_stack([np.linspace(8, 28, 100), np.full(100, 6.0)])
    assert at(kerbed, *on) == pytest.approx(np.full(100, 0.125), abs=1e-6)
    assert np.unique(kerbed.roughness_at(on)).tolist() == ["flat"]
    assert kerbed.roughness_at(np.array([[20.0, 20.0], [np.nan, 0.0]])[:1]).tolist() == ["F"]


def test_a_ditch_runs_beside_the_roads_and_leaves_crossings_open():
    terrain = built({"kind": "ditch", "offset": 2, "width": 3, "bottom": 1, "depth": 0.8})
    section = [(20, 4 + 2 + t) for t in (-1.5, 0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 6)]
    shape = np.array([0, 0, -0.4, -0.8, -0.8, -0.8, -0.4, 0, 0])
    assert at(terrain, *section) == pytest.approx(shape, abs=1e-6)
    assert not at(terrain, *[(x, y) for x in np.linspace(-29, 29, 60) for y in (-3.5, 0, 3.5)]).any()


def test_a_ditch_along_a_path_ends_where_a_road_is():
    terrain = built({"kind": "ditch", "path": [[-20, -20], [20, 20]], "depth": 1, "width": 2}, shoulder=2.0)
    assert at(terrain, (15, 15), (-15, -15), (10, 18)) == pytest.approx([-1, -1, 0], abs=1e-6)
    assert at(terrain, (0, 0), (2, 2), (-3.5, -3.5)) == pytest.approx([0, 0, 0])


def arc(radius, start, stop, step=0.5):
    a = np.arange(start, stop, step / radius * np.sign(stop - start))
    return np.column_stack([radius * np.cos(a), radius * np.sin(a)])


@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_a_bend_leans_by_the_formula_inside_edge_low(turn):
    """e = v²/(g R) - f, four lanes turning as one about their middle."""
    lanes = [Road(arc(60 + 4 * k, 0.0 if turn > 0 else 3.0, 3.0 if turn > 0 else 0.0), 4.0) for k in range(3)]
    e = 15.0**2 / 9.81 / 64 - 0.3
    layer = {"kind": "bank", "speed": 15, "side_friction": 0.3, "limit": 0.2, "runoff": 20, "verge": 5}
    terrain = built(layer, roads=lanes, area=(-80, -10, 80, 80))
    for r in (58.5, 61, 64, 67, 69.5):
        assert at(terrain, (0, r)) == pytest.approx([e * (r - 64)], abs=4e-3)
    assert at(terrain, (0, 75.5), (0, 52), (0, 20)) == pytest.approx([0, 0, 0], abs=1e-6)
    low = built({**layer, "limit": 0.03}, roads=lanes, area=(-80, -10, 80, 80))
    assert at(low, (0, 68.0)) == pytest.approx([0.03 * 4], abs=4e-3)


def test_super_elevation_builds_up_over_the_runoff_and_is_none_on_the_straight():
    R = 50.0
    bend = np.vstack([[[R, -s] for s in np.arange(80.0, 0, -0.5)], arc(R, 0.0, 2.5)])
    roads = [Road(bend[:161], 6.0), Road(bend[160:], 6.0)]
    layer = {"kind": "bank", "speed": 20, "side_friction": 0, "limit": 0.1, "runoff": 30, "verge": 4}
    terrain = built(layer, roads=roads, area=(-60, -85, 60, 60))
    edge = at(terrain, *[(R + 2, -s) for s in (60, 30, 15.5, 0)])
    assert edge[:3] == pytest.approx([0, 0, 0], abs=0.012)
    assert edge[3] == pytest.approx(0.1, abs=0.03)  # half built up where the bend begins
    a = 1.2
    assert at(terrain, ((R + 2) * np.cos(a), (R + 2) * np.sin(a))) == pytest.approx([0.2], abs=5e-3)


def test_where_banked_roads_cross_the_ground_has_no_step():
    roads = [Road(arc(40, 0, 6.28), 8.0), Road(np.array([[0.0, -80.0], [0.0, 80.0]]), 8.0)]
    terrain = built(
        {"kind": "bank", "speed": 12, "limit": 0.1, "verge": 6}, roads=roads, area=(-60, -60, 60, 60)
    )
    assert terrain.height.max() > 0.2
    for axis in (0, 1):
        assert np.abs(np.diff(terrain.height, axis=axis)).max() < 0.3 * CELL
    around = [(44 * np.cos(a), 44 * np.sin(a)) for a in np.linspace(0.3, 1.2, 30)]
    assert np.ptp(at(terrain, *around)) < 0.02


def test_lanes_go_on_into_each_other_and_lie_side_by_side():
    straight = np.column_stack([np.zeros(41), np.arange(-20.0, 0.5, 0.5)])
    onward = straight + np.array([0, 20])
    back = straight[::-1] + np.array([4, 0])
    branch = arc(10, np.pi, np.pi / 2) + np.array([10, 0])
    ways = carriageways([Road(straight, 4.0), Road(onward, 4.0), Road(back, 4.0), Road(branch, 4.0)])
    assert sorted(round(float(np.hypot(*np.diff(w.line, axis=0).T).sum())) for w in ways) == [15, 40]
    both = max(ways, key=lambda w: len(w.line))
    assert sorted((both.left, both.right)) == pytest.approx([2, 6])


def test_offsets_are_to_the_left_and_places_count_segments():
    line = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])
    found = offsets(line, np.array([[5.0, 2.0], [12.0, 5.0], [10.0, 13.0]]))
    assert found == pytest.approx(np.array([[2, 2, 0.5], [2, -2, 1.5], [3, 0, 2]]))


def test_lanes_that_miss_each_other_by_a_little_join_without_a_jog():
    first = np.column_stack([np.arange(0.0, 40.5, 0.5), np.zeros(81)])
    second = np.column_stack([np.arange(40.0, 80.5, 0.5), np.full(81, 0.5)])
    (way,) = carriageways([Road(first, 4.0), Road(second, 4.0)])
    heading = np.arctan2(*np.diff(way.line, axis=0).T[::-1])
    assert np.abs(np.diff(heading)).max() < 0.04
    assert way.line[-1] == pytest.approx([80.0, 0.5])
