"""The gallery shows every asset, and its clouds are what the rays say."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from datmo.messages import Kind
from sim.picture.gallery import sheet as gallery
from sim.picture.gallery.cloud import HEIGHT, NEAR, NOISE, cloud
from sim.picture.gallery.exhibits import persons, things, vehicles
from sim.picture.gallery.listing import catalogue
from sim.picture.gallery.scenes import presets, scene
from sim.picture.gallery.view import Camera, camera, colours, mesh_view, splat
from sim.picture.grounds import ground_names
from sim.scene import assets
from sim.scene.scenery.kinds import SORTS

CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (0, 2)], np.float32)
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CUBE = np.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))], np.int32)


def test_every_kind_is_shown():
    shown = {e.name for e in vehicles()} | {e.name for e in persons()}
    assert set(assets.catalogue()) <= shown
    assert {e.kind for e in persons()} == {Kind.PEDESTRIAN}
    assert {e.name for e in things()} == set(SORTS)


def test_the_catalogue_tells_every_exhibit_and_ground():
    rows = catalogue()
    assert list(rows) == list(gallery.SHEETS)
    assert [r.name for r in rows["vehicles"]] == [e.name for e in vehicles()]
    assert [r.name for r in rows["things"]] == list(SORTS)
    assert [r.name for r in rows["grounds"]] == list(ground_names())
    assert {r.name for r in rows["vehicles"] + rows["persons"]} == set(assets.catalogue())
    assert all(row.note and int(row.triangles.split("-")[0]) > 10 for group in rows.values() for row in group)


@pytest.mark.parametrize("azimuth", [0.0, 50.0, 200.0])
def test_a_camera_frames_the_box_and_finds_its_rays_again(azimuth):
    view = camera(np.array([-3.0, -1.0, 0.0]), np.array([3.0, 1.0, 2.0]), (60, 90), azimuth)
    corners = np.array([[x, y, z] for x in (-3, 3) for y in (-1, 1) for z in (0, 2)], float)
    at, depth = view.pixels(corners)
    assert (depth > 0).all()
    assert ((at > 0) & (at < [90, 60])).all()
    rays = view.directions().reshape(60, 90, 3)
    at, _ = view.pixels(view.eye + 7.0 * rays[[10, 40], [20, 70]])
    assert at == pytest.approx(np.array([[20.5, 10.5], [70.5, 40.5]]))


def test_a_mesh_stands_lit_before_its_shadow():
    view = camera(np.array([-1.0, -1, 0]), np.array([1.0, 1, 2]), (60, 80), 40.0)
    image = mesh_view(CORNERS, CUBE, np.full((12, 3), [200.0, 0, 0]), view)
    red = (image[..., 0] > 60) & (image[..., 1] < 20)
    assert 0.1 < red.mean() < 0.7
    assert len(np.unique(image[red][:, 0])) >= 3  # three faces, three shades
    floor = image[(image[..., 0] == image[..., 0].clip(100, 235)) & (image[..., 1] > 100)]
    assert (floor[:, 1] < 140).any()  # in the shadow
    assert (floor[:, 1] > 220).any()


def test_a_cloud_lies_on_the_mesh_and_the_floor():
    points, which = cloud(CORNERS, CUBE, 30.0)
    assert (which >= 0).sum() > 300
    on = points[which >= 0]
    assert np.abs(np.abs(on[:, :2]).max(1) - 1).max() < 6 * NOISE
    assert np.abs(points[which < 0, 2]).max() < 6 * NOISE
    stand = (NEAR + 1.366) * np.array([np.cos(np.pi / 6), np.sin(np.pi / 6)])
    apart = np.hypot(*(on[:, :2] - stand).T)
    assert apart.min() == pytest.approx(NEAR, abs=0.05)
    assert on[:, 2].max() < HEIGHT + 0.045 * 13


def test_a_scene_is_ground_things_and_vehicles_in_one():
    made = scene("street")
    assert len(made.colour) == len(made.triangles) > 300_000
    assert np.isfinite(made.vertices).all()
    assert made.triangles.max() == len(made.vertices) - 1
    assert set(presets()) == {"street", "country-road", "forest"}


def test_dots_hide_those_behind_them():
    view = Camera(np.zeros(3), np.array([[0.0, -1, 0], [0, 0, 1], [1, 0, 0]]), 0.02, (20, 20))
    points = np.array([[5.0, 0, 0], [9.0, 0, 0]])
    image = splat(view, points, np.array([[250.0, 0, 0], [0, 250, 0]]), (0, 0, 0))
    assert tuple(image[10, 10]) == (250, 0, 0)


def test_colours_are_the_kinds_and_darker_for_glass():
    paint, glass = colours(np.full(2, Kind.CAR, np.uint8), np.array([0.5, 0.05], np.float32))
    assert (glass < paint).all()


def test_a_sheet_is_small_and_holds_all():
    page = gallery.sheet([gallery.exhibit(one) for one in things()[:4]], 3)
    assert page.size == (3 * 408 + 8, 2 * 188 + 8)
    data = gallery.encoded(page)
    assert len(data) < gallery.LARGEST
    assert np.array(Image.open(io.BytesIO(data)).convert("RGB")).std() > 20
    assert len(gallery.encoded(page, 3000)) < len(data)
