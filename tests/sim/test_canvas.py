from __future__ import annotations

import numpy as np

from sim.canvas import BACKGROUND, Canvas


def test_forward_is_up_and_left_is_left() -> None:
    canvas = Canvas(pixels=100, radius=50)
    canvas.points(np.array([[40.0, 0.0]]), (255, 0, 0))
    canvas.points(np.array([[0.0, 40.0]]), (0, 255, 0))
    red = np.argwhere((canvas.image == (255, 0, 0)).all(-1))[0]
    green = np.argwhere((canvas.image == (0, 255, 0)).all(-1))[0]
    assert red.tolist() == [10, 50]
    assert green.tolist() == [50, 10]


def test_lines_have_no_gaps() -> None:
    canvas = Canvas(pixels=100, radius=50)
    canvas.line(np.array([[-30.0, -20.0], [30.0, 10.0]]), (255, 255, 255))
    drawn = np.argwhere((canvas.image == 255).all(-1))
    rows = np.unique(drawn[:, 0])
    assert rows.tolist() == list(range(rows.min(), rows.max() + 1))


def test_what_lies_outside_is_left_out() -> None:
    canvas = Canvas(pixels=50, radius=10)
    canvas.points(np.array([[99.0, 0.0], [0.0, -99.0]]), (255, 255, 255))
    canvas.line(np.array([[np.nan, 0.0], [1.0, 1.0]]), (255, 255, 255))
    canvas.number(np.array([500.0, 500.0]), 12, (255, 255, 255))
    assert (canvas.image == BACKGROUND).all()


def test_numbers_differ() -> None:
    pictures = []
    for value in range(10):
        canvas = Canvas(pixels=50, radius=10)
        canvas.number(np.zeros(2), value, (255, 255, 255))
        pictures.append(canvas.image.tobytes())
    assert len(set(pictures)) == 10
