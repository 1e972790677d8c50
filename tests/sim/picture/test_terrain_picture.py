from __future__ import annotations

import numpy as np
import pytest

from scenarios import spec
from sim.picture.terrain import COLOURS, SKY, terrain_picture, terrain_view
from sim.scene.roads import Road
from sim.scene.terrain import build_terrain


@pytest.fixture(scope="module")
def hill():
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DATMO_CACHE_DIR", "off")
        layers = [{"kind": "hill", "at": [10, 0], "height": 4, "radius": 5}]
        road = Road(np.array([[-18.0, -40.0], [-18.0, 40.0]]), 8.0)
        ground = spec.Terrain(cell=0.5, layers=layers)
        return build_terrain(ground, [road], (-30, -20, 30, 20), np.random.SeedSequence(0))


def hue(image):
    return np.argmax(image, axis=-1)


def test_from_above_north_is_up_and_the_light_comes_from_the_upper_left(hill):
    image = terrain_picture(hill, 300)
    assert image.shape == (200, 300, 3)
    assert image.dtype == np.uint8
    green, blue = 1, 2
    assert (hue(image[:, 48:72]) == blue).all()  # the road, x from -22 to -14 m
    assert (hue(image[:, :36]) == green).all()
    upper_left, lower_right = image[82, 182].sum(), image[118, 218].sum()
    assert upper_left > 1.5 * lower_right


def test_flat_ground_has_the_colour_of_its_kind_everywhere():
    flat = build_terrain(spec.Terrain(cell=1.0), [], (0, 0, 9, 9), np.random.SeedSequence(0))
    image = terrain_picture(flat, 40)
    assert (image == image[0, 0]).all()
    assert np.argmax(image[0, 0]) == np.argmax(COLOURS[10])


def test_in_perspective_the_hill_stands_before_the_sky(hill):
    eye, target = np.array([10.0, -40.0, 1.0]), np.array([10.0, 0.0, 1.0])
    image = terrain_view(hill, 200, eye, target, fov_deg=60)
    assert image.shape == (120, 200, 3)
    sky = (image == SKY).all(-1)
    assert sky[:20].all()
    skyline = np.argmin(sky, axis=0)
    assert abs(int(np.argmin(skyline)) - 100) <= 12
    top = 60 - (4.0 - 1.0) / 40 * (200 / 2) / np.tan(np.deg2rad(30))
    assert skyline.min() == pytest.approx(top, abs=2)


def test_every_look_is_the_same(hill):
    assert np.array_equal(terrain_view(hill, 60), terrain_view(hill, 60))
    assert np.array_equal(terrain_picture(hill, 60), terrain_picture(hill, 60))
