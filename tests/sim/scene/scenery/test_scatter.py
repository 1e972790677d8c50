"""Scenery by rule: off the roads, none inside another, the same again."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from datmo.messages import Kind
from scenarios import spec
from scenarios.spec.scenery import PRESETS
from sim.scan.things import place
from sim.scene.roads import Road
from sim.scene.scenery.edges import Edges
from sim.scene.scenery.parking import parked
from sim.scene.scenery.place import size_of
from sim.scene.scenery.plot import Plots, foot, outline, overlap, rectangle, room
from sim.scene.scenery.scatter import scatter
from sim.scene.terrain import build_terrain

AREA = (-60.0, -60.0, 60.0, 60.0)
SEED = np.random.SeedSequence(5)


def crossing():
    """Two lanes along y and two along x, and a bend."""
    run = np.arange(-70.0, 70.5, 0.5)
    roads = [Road(np.column_stack([np.full_like(run, x), run]), 4.0) for x in (-2.0, 2.0)]
    roads += [Road(np.column_stack([run, np.full_like(run, y)]), 4.0) for y in (-2.0, 2.0)]
    a = np.linspace(-np.pi / 2, 0, 60)
    return [*roads, Road(np.column_stack([-40 + 30 * np.cos(a), -5 + 30 * np.sin(a)]), 3.5)]


ROADS = crossing()


def beyond(roads, points):
    """The slow way: the least distance to any segment of any road, less half the road's width."""
    least = np.full(len(points), np.inf)
    for road in roads:
        a, e = road.centerline[:-1], np.diff(road.centerline, axis=0)
        to = points[:, None] - a
        t = np.clip((to * e).sum(2) / (e * e).sum(1), 0, 1)
        gap = np.sqrt(((to - t[..., None] * e) ** 2).sum(2))
        least = np.minimum(least, gap.min(1) - road.width / 2)
    return least


@pytest.fixture(scope="module")
def field():
    return build_terrain(spec.Terrain(roughness="D", grade=0.05), ROADS, AREA, np.random.SeedSequence(1))


@pytest.fixture(scope="module")
def kerbed():
    model = spec.Terrain.model_validate({"layers": [{"kind": "kerb", "sidewalk": 2.0}]})
    return build_terrain(model, ROADS, AREA, np.random.SeedSequence(1))


def laid(name, terrain, seed=SEED):
    return scatter(spec.Scenery(preset=name), ROADS, terrain, AREA, seed)


OTHERS = sorted(set(PRESETS) - {"none", "street"})


@pytest.mark.parametrize("name", ["street", *(pytest.param(n, marks=pytest.mark.long) for n in OTHERS)])
@pytest.mark.parametrize("ground", ["field", "kerbed"])
def test_nothing_stands_on_a_road_or_sidewalk(name, ground, request):
    terrain = request.getfixturevalue(ground)
    things = laid(name, terrain)
    assert len(things) > 40
    for thing in things:
        points = outline(foot(thing))
        assert (terrain.kind_at(points) == Kind.FIELD).all(), thing
        assert beyond(ROADS, points).min() > 0


@pytest.mark.parametrize("name", ["street", pytest.param("forest", marks=pytest.mark.long)])
def test_no_two_share_their_ground(name, field):
    rooms = [room(thing) for thing in laid(name, field)]
    assert not any(overlap(a, b) for a, b in combinations(rooms, 2))


def test_the_same_seed_gives_the_same_bytes_and_another_does_not(field):
    a, b, c = laid("street", field), laid("street", field), laid("street", field, np.random.SeedSequence(6))
    assert a == b
    assert a != c
    assert place(a, field).mesh.vertices.tobytes() == place(b, field).mesh.vertices.tobytes()


def test_no_scenery_is_none(field):
    assert laid("none", field) == ()
    assert parked(spec.Scenery(), ROADS, SEED, AREA) == ()


def test_a_rule_does_not_change_the_luck_of_those_before_it(field):
    one = spec.Scenery(rows=(spec.Row(kind="tree"),))
    two = spec.Scenery(rows=(spec.Row(kind="tree"), spec.Row(kind="lamp", offset=(6, 6))))
    first, both = (scatter(s, ROADS, field, AREA, SEED) for s in (one, two))
    assert both[: len(first)] == first
    assert len(both) > len(first)


def test_what_is_taken_stays_free(field):
    way = rectangle(np.array([20.0, 7.0]), 0.0, 40.0, 8.0)
    rows = spec.Scenery(rows=(spec.Row(kind="tree", every=4.0, offset=(1, 4)),))
    free = scatter(rows, ROADS, field, AREA, SEED)
    kept = scatter(rows, ROADS, field, AREA, SEED, [way])
    assert any(overlap(room(t), way) for t in free)
    assert not any(overlap(room(t), way) for t in kept)


def test_crowns_hardly_reach_over_the_road(field):
    things = [t for name in ("street", "forest") for t in laid(name, field) if t.kind in ("tree", "conifer")]
    assert len(things) > 50
    for thing in things:
        radius = max(size_of(thing)[:2]) / 2
        assert beyond(ROADS, np.array([thing.at]))[0] >= radius - 0.8 - 1e-3


@pytest.mark.long
@settings(max_examples=12, deadline=None)
@given(st.floats(-0.06, 0.06), st.floats(-0.06, 0.06), st.floats(3, 14), st.integers(0, 99))
def test_nothing_stands_on_any_winding_road(bend, twist, width, seed):
    s = np.arange(-60.0, 60.5, 1.0)
    yaw = bend * s + twist * s**2 / 40
    road = Road(np.column_stack([np.cumsum(np.cos(yaw)), np.cumsum(np.sin(yaw))]), width)
    low, high = road.centerline.min(0) - 15, road.centerline.max(0) + 15
    area = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    ground = build_terrain(spec.Terrain(cell=1.0), [road], area, np.random.SeedSequence(1))
    scenery = spec.Scenery(preset="country-road", parking=(spec.Parking(),))
    standing = parked(scenery, [road], np.random.SeedSequence(seed), area)
    things = scatter(scenery, [road], ground, area, np.random.SeedSequence(seed))
    for corners in [one.corners for one in standing] + [foot(thing) for thing in things]:
        assert beyond([road], outline(corners)).min() > 0


def test_rows_keep_their_offset_and_side(field):
    row = spec.Row(kind="lamp", offset=(1.0, 1.5), every=9.0, side="right")
    things = scatter(spec.Scenery(rows=(row,)), ROADS, field, AREA, SEED)
    assert len(things) > 8
    for thing in things:
        off = beyond(ROADS, np.array([thing.at]))[0]
        assert 0.7 < off < 1.8
        arm = np.radians(thing.yaw_deg + 90)
        tip = np.array(thing.at) + 1.5 * np.array([np.cos(arm), np.sin(arm)])
        assert beyond(ROADS, tip[None])[0] < off  # the arm reaches towards the road


def test_a_line_closes_up(field):
    row = spec.Row(kind="fence", offset=(3.0, 3.0), every=5.0, side="right")
    straight = [ROADS[1]]
    things = scatter(spec.Scenery(rows=(row,)), straight, field, AREA, SEED)
    ys = np.sort([t.at[1] for t in things])
    assert len(things) > 3
    assert {t.size[0] for t in things} == {5.0}
    assert np.diff(ys)[np.diff(ys) < 9] == pytest.approx(5.0, abs=1e-3)


def test_what_is_strewn_keeps_clear(field):
    scenery = spec.Scenery(strewn=(spec.Strewn(kind="bush", density=80, clear=6.0),))
    things = scatter(scenery, ROADS, field, AREA, SEED)
    assert len(things) > 20
    assert min(beyond(ROADS, outline(foot(t))).min() for t in things) >= 6.0


def test_what_is_strewn_has_its_density_wherever_the_area_ends():
    bare = build_terrain(spec.Terrain(cell=1.0), (), (-150, -150, 150, 150), np.random.SeedSequence(1))
    scenery = spec.Scenery(strewn=(spec.Strewn(kind="bollard", density=80),))
    some = {t.at for t in scatter(scenery, (), bare, AREA, SEED)}
    more = {t.at for t in scatter(scenery, (), bare, (-140, -140, 140, 140), SEED)}
    assert len(some) == pytest.approx(80 * 1.44, abs=4 * np.sqrt(115))
    assert len(more) == pytest.approx(80 * 7.84, abs=4 * np.sqrt(627))
    assert len(some & more) >= len(some) - 1  # at the rim another may have come first


def test_parked_vehicles_stand_off_the_roads_and_apart():
    vehicles = parked(
        spec.Scenery(parking=(spec.Parking(vans=0.3, trucks=0.1, every=12),)), ROADS, SEED, AREA
    )
    assert len(vehicles) > 10
    assert {v.kind for v in vehicles} >= {Kind.CAR, Kind.VAN}
    for v in vehicles:
        assert beyond(ROADS, outline(v.corners)).min() > 0
    assert not any(overlap(a.corners, b.corners) for a, b in combinations(vehicles, 2))
    again = parked(spec.Scenery(parking=(spec.Parking(vans=0.3, trucks=0.1, every=12),)), ROADS, SEED, AREA)
    assert [(v.asset, *v.xy, v.yaw) for v in vehicles] == [(v.asset, *v.xy, v.yaw) for v in again]


@settings(max_examples=40, deadline=None)
@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0, 3.1), st.floats(0, 3.1))
def test_overlap_is_what_a_fine_raster_says(x, y, yaw_a, yaw_b):
    a = rectangle(np.zeros(2), yaw_a, 3.0, 1.5)
    b = rectangle(np.array([x, y]), yaw_b, 2.0, 2.0)
    grid = np.stack(np.meshgrid(np.linspace(-3, 3, 61), np.linspace(-3, 3, 61)), -1).reshape(-1, 2)
    both = _inside(grid, a) & _inside(grid, b)
    if both.any():
        assert overlap(a, b)
    assert overlap(a, b) == overlap(b, a)
    if overlap(a, b):
        assert (_inside(grid, a, 0.1) & _inside(grid, b, 0.1)).any()


def _inside(points, corners, slack=0.0):
    inside = np.ones(len(points), bool)
    for p, q in zip(corners, np.roll(corners, -1, 0), strict=True):
        e = (q - p) / np.hypot(*(q - p))
        inside &= e[0] * (points[:, 1] - p[1]) - e[1] * (points[:, 0] - p[0]) >= -slack
    return inside


@pytest.mark.parametrize("reach", [np.inf, 5.0, 0.05])
def test_edges_are_what_every_segment_says(reach):
    points = np.random.default_rng(2).uniform(-55, 55, (60, 2))
    for some in (points, *np.array_split(points, 20)):
        found = Edges(ROADS).beyond(some, reach)
        assert found == pytest.approx(np.minimum(beyond(ROADS, some), reach), abs=1e-9)


def test_plots_grow(field):
    plots = Plots(Edges(()), field)
    spots = [(float(x), float(y)) for x in range(-45, 46, 9) for y in range(-45, 46, 9)]
    clear = [plots.take(spec.Thing(kind="bollard", at=at)) for at in spots]
    again = [plots.take(spec.Thing(kind="bollard", at=at)) for at in spots]
    assert sum(clear) > 64
    assert not any(again)


def test_impossible_rules_are_refused():
    with pytest.raises(ValidationError, match="offset"):
        spec.Row(kind="tree", offset=(4, 2))
    with pytest.raises(ValidationError, match="more than all"):
        spec.Parking(vans=0.7, trucks=0.7)
    with pytest.raises(ValidationError, match="preset"):
        spec.Scenery(preset="jungle")


def test_vehicles_parked_across_show_nose_or_tail_and_stand_apart():
    rules = (spec.Parking(share=1.0, across=True, gap=1.0, side="left"), spec.Parking(side="right"))
    both = parked(spec.Scenery(parking=rules), ROADS, SEED, AREA)
    alone = parked(spec.Scenery(parking=rules[:1]), ROADS, SEED, AREA)
    assert 5 < len(alone) < len(both)
    assert [one.asset for one in both[: len(alone)]] == [one.asset for one in alone]
    for i, one in enumerate(both):
        assert not any(overlap(one.corners, other.corners) for other in both[:i])
    ends = np.array([np.sort(Edges(ROADS).beyond(one.corners)) for one in alone])
    assert ends[:, 0].min() > 0.3
    assert (ends[:, 1] < 1.4).mean() > 0.8  # but where another road is near
    assert (ends[:, 3] > 4.0).mean() > 0.8  # the other end
    assert len({round(float(one.yaw) / (np.pi / 2)) % 4 for one in alone}) >= 2


def test_one_rule_of_parking_is_a_list_of_one():
    assert spec.Scenery(parking=None).parking == ()
    assert spec.Scenery.model_validate({"parking": {"share": 0.4}}).parking == (spec.Parking(share=0.4),)
    assert spec.Scenery.model_validate({"parking": [{"share": 0.4}, {}]}).parking[1] == spec.Parking()
