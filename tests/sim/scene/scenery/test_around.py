"""Scenery in a world: it comes with its own luck, and listed things come first."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.messages import Kind
from scenarios import spec
from scenarios.load import load
from sim.scene.scenery.around import around, ways
from sim.scene.scenery.plot import foot, overlap
from sim.scene.world import World


@pytest.fixture(scope="module")
def bare():
    return load("rough-crossing")


@pytest.fixture(scope="module")
def world(bare):
    return World(bare, np.random.SeedSequence(4))


def test_without_scenery_there_is_nothing_but_what_is_listed(bare, world):
    assert world.things == bare.things
    assert world.parked == ()


def test_scenery_leaves_the_luck_of_ground_and_traffic_alone(bare, world):
    lush = bare.model_copy(update={"scenery": spec.Scenery(preset="country-road")})
    other = World(lush, np.random.SeedSequence(4))
    assert len(other.things) > 100
    assert other.terrain.height.tobytes() == world.terrain.height.tobytes()
    a, b = other.reset(), World(bare, np.random.SeedSequence(4)).reset()
    assert a.id.tobytes() == b.id.tobytes()
    driven = a.kind != Kind.PEDESTRIAN  # walkers go around what stands there
    assert driven.sum() > 10
    assert a.T_world_actor[driven].tobytes() == b.T_world_actor[driven].tobytes()


@pytest.mark.long
def test_listed_things_come_first_and_ways_stay_free(bare, world):
    listed = (spec.Thing(kind="building", at=(20.0, 20.0)),)
    scenery = spec.Scenery(preset="street", parking=(spec.Parking(share=1.0),))
    lush = bare.model_copy(update={"things": listed, "scenery": scenery})
    things, standing = around(lush, world.roads, world.terrain, np.random.SeedSequence(4))
    assert things[:1] == listed
    assert len(things) > 100
    assert len(standing) > 20
    for way in ways(lush):
        assert not any(overlap(way, foot(thing)) for thing in things[1:])
        assert not any(overlap(way, one.corners) for one in standing)
    for one in standing:
        assert not any(overlap(one.corners, foot(thing)) for thing in things)
