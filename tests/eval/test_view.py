from __future__ import annotations

import numpy as np
import pytest

from datmo.messages import Boxes, Clusters, Frame, Ground, Scan, Tracks
from eval.view import BirdsEye, bird_eye
from sim.picture import palette
from sim.picture.raster import GLYPHS, Raster


def alone(xy: list[list[float]], ground: bool, **parts: object) -> Frame:
    points = np.c_[np.array(xy, float), np.full(len(xy), -1.73)]
    n = len(points)
    made = {"boxes": Boxes.empty(), "tracks": Tracks.empty()} | parts
    T = made.pop("T", np.eye(4))
    return Frame(
        scan=Scan(points=points, T_world_sensor=T),
        ground=Ground(np.full(n, ground), np.zeros(n), np.zeros(n)),
        clusters=Clusters(np.zeros(n), 1),
        **made,
    )


def where(image: np.ndarray, colour: tuple[int, int, int], slack: int = 3) -> np.ndarray:
    return np.argwhere(np.abs(image.astype(int) - np.array(colour)).max(-1) <= slack)


def test_forward_is_up_and_left_is_left() -> None:
    image = bird_eye(alone([[30.0, 20.0]], ground=False))
    rows = where(image, palette.track_colour(0, 0.55))
    assert len(rows) == 4
    np.testing.assert_allclose(rows.mean(0), [(50 - 30) * 8 + 0.5, (50 - 20) * 8 + 0.5], atol=1)


def test_a_stroke_lies_where_a_slow_ruler_says() -> None:
    raster = Raster(60, 30.0)
    a, b = np.array([[12.0, -20.0]]), np.array([[-17.0, 9.0]])
    raster.segments(a, b, (255, 255, 255), width=2.0)
    (ar, ac), (br, bc) = raster.pixel(a)[0], raster.pixel(b)[0]
    expected = np.zeros((60, 60))
    for r in range(60):
        for c in range(60):
            s = np.clip(
                ((r - ar) * (br - ar) + (c - ac) * (bc - ac)) / ((br - ar) ** 2 + (bc - ac) ** 2), 0, 1
            )
            distance = np.hypot(r - ar - s * (br - ar), c - ac - s * (bc - ac))
            expected[r, c] = np.clip(1.5 - distance, 0, 1)
    base = Raster(60, 30.0).image.astype(float)
    wanted = base * (1 - expected[..., None]) + 255 * expected[..., None]
    np.testing.assert_allclose(raster.image, wanted, atol=1)


def test_strokes_and_dots_outside_leave_the_picture_alone() -> None:
    raster = Raster(40, 10.0)
    before = raster.image.copy()
    raster.segments([[50.0, 50.0], [np.nan, 0.0]], [[60.0, 80.0], [1.0, 1.0]], (255, 0, 0))
    raster.dots(np.array([[11.0, 0.0], [np.nan, 1.0], [1e30, -1e30]]), np.full((3, 3), 255, np.uint8), 2)
    raster.number(np.array([12.0, 0.0]), 7, (255, 0, 0))
    np.testing.assert_array_equal(raster.image, before)


def test_digits_read_as_they_should() -> None:
    raster = Raster(40, 10.0)
    raster.number(np.array([0.0, 0.0]), 47, (255, 255, 255), size=1)
    lit = (raster.image == 255).all(-1)
    rows, columns = np.nonzero(lit)
    crop = lit[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
    bits = [(GLYPHS[d][:, None] >> np.array([2, 1, 0])) & 1 for d in (4, 7)]
    np.testing.assert_array_equal(crop, np.hstack([bits[0], np.zeros((5, 1)), bits[1]]).astype(bool))


def test_mistakes_stand_out(stage) -> None:
    frame, truth = stage(0)
    assert len(where(bird_eye(frame, truth), palette.LEAKED)) > 0
    right = Frame(
        frame.scan, Ground(truth.is_ground, truth.height, truth.height), frame.clusters, *rest(frame)
    )
    assert len(where(bird_eye(right, truth), palette.LEAKED)) == 0


def rest(frame: Frame) -> tuple[Boxes, Tracks]:
    return frame.boxes, frame.tracks


def test_a_box_turns_with_the_ego() -> None:
    """The same box in the world, seen from two headings, keeps its place about the ego."""
    box = Boxes(center=[[20.0, 0.0, 0.0]], size=[[8.0, 2.0, 2.0]], yaw=[0.0])
    turned = np.eye(4)
    turned[:2, :2] = [[0, -1], [1, 0]]  # the ego looks along +y, the box lies to its right
    middles = []
    for T in (np.eye(4), turned):
        image = bird_eye(alone([[2.0, 2.0]], True, boxes=box, T=T))
        middles.append(where(image, palette.DETECTION, 8).mean(0))
    np.testing.assert_allclose(middles, [[240, 400], [400, 560]], atol=2)


def test_tails_follow_tracks_and_end_with_them(stage) -> None:
    eye = BirdsEye(tail=3)
    for k in range(14):  # the track of the car changes its id at frame 12
        eye.follow(stage(k)[0])
    assert {key: len(places) for key, places in eye._tails.items()} == {31: 2, 12: 4, 13: 4}
    frame, truth = stage(13)
    assert not np.array_equal(eye.draw(frame, truth), bird_eye(frame, truth))


def test_pictures_repeat_and_take_odd_points(stage) -> None:
    frame, truth = stage(3)
    np.testing.assert_array_equal(bird_eye(frame, truth), bird_eye(frame, truth))
    odd = alone([[np.nan, 1.0], [np.inf, 0.0], [5.0, 5.0]], ground=True)
    assert bird_eye(odd, radius=20, pixels=200).shape == (200, 200, 3)
    empty = alone([[np.nan, np.nan]], ground=True)
    assert bird_eye(empty).dtype == np.uint8


@pytest.mark.parametrize("pair", [(1, 2), (11, 31), (7, 8)])
def test_colours_of_ids_differ(pair: tuple[int, int]) -> None:
    a, b = (np.array(palette.track_colour(i), int) for i in pair)
    assert np.abs(a - b).sum() > 60
