from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.geometry import transform
from scenarios import spec
from sim.scene.contact import TRACK, TYRE, WHEELBASE, stand
from sim.scene.terrain import build_terrain

AREA = (-30.0, -30.0, 30.0, 30.0)


def built(**changes):
    return build_terrain(spec.Terrain(**changes), [], AREA, np.random.SeedSequence(4))


@pytest.fixture(scope="module")
def plane():
    return built(grade=0.12, cross_slope=-0.07)


@pytest.fixture(scope="module")
def rough():
    return built(grade=0.06, roughness="E")


@settings(max_examples=25, deadline=None)
@given(x=st.floats(-20, 20), y=st.floats(-20, 20), yaw=st.floats(-4, 4), length=st.floats(0.3, 12))
def test_on_a_plane_the_whole_footprint_touches_it(plane, x, y, yaw, length):
    T = stand(plane, np.array([x, y]), np.array(yaw), length, 1.8)
    R = T[:3, :3]
    assert pytest.approx(np.eye(3), abs=1e-12) == R @ R.T
    assert np.linalg.det(R) == pytest.approx(1)
    floor = transform(T, np.array([[i, j, 0.0] for i in (-2, 0, 2) for j in (-1, 0, 1)]))
    assert floor[:, 2] == pytest.approx(floor[:, :2] @ [-0.07, 0.12], abs=1e-5)
    assert np.arctan2(R[1, 0], R[0, 0]) == pytest.approx(np.arctan2(np.sin(yaw), np.cos(yaw)), abs=1e-9)


def test_least_squares_by_hand(rough):
    """The closed form against numpy's solver through the twenty weighted samples."""
    xy, yaw, length, width = np.array([3.0, -4.0]), 0.7, 4.5, 1.8
    c, s = np.cos(yaw), np.sin(yaw)
    rows, heights = [], []
    for i in (1, -1):
        for j in (1, -1):
            x, y = i * length * WHEELBASE / 2, j * width * TRACK / 2
            under = [
                rough.height_at(xy + np.array([[c * (x + o) - s * y, s * (x + o) + c * y]]))[0]
                for o, _ in TYRE
            ]
            rows.append([1, x, y])
            heights.append(np.average(under, weights=[w for _, w in TYRE]))
    (z, a, b), *_ = np.linalg.lstsq(np.array(rows), np.array(heights), rcond=None)
    T = stand(rough, xy, np.array(yaw), length, width)
    assert T[2, 3] == pytest.approx(z, abs=1e-9)
    assert T[2, 0] / np.hypot(T[0, 0], T[1, 0]) == pytest.approx(a, abs=1e-9)
    normal = np.array([-a, -b, 1]) / np.sqrt(a * a + b * b + 1)
    assert T[:3, 2] == pytest.approx(
        [c * normal[0] - s * normal[1], s * normal[0] + c * normal[1], normal[2]]
    )


def test_many_at_once_are_each_alone(rough):
    rng = np.random.default_rng(0)
    xy, yaw = rng.uniform(-20, 20, (5, 7, 2)), rng.uniform(-3, 3, (5, 7))
    length, width = rng.uniform(1, 8, (5, 1)), rng.uniform(0.5, 2.5, (5, 1))
    upright = np.array([[False], [True], [False], [True], [False]])
    T = stand(rough, xy, yaw, length, width, upright)
    assert T.shape == (5, 7, 4, 4)
    for k in range(5):
        alone = stand(rough, xy[k, 3], yaw[k, 3], length[k, 0], width[k, 0], bool(upright[k, 0]))
        assert np.array_equal(T[k, 3], alone)
    assert (T[[1, 3], :, 2, 2] == 1).all()
    assert (T[0, :, 2, 2] < 1).all()


def test_the_pose_moves_without_jumps(rough):
    """A car at 10 m/s, each 1 ms: 1 cm ahead changes heights by no more than the slope allows."""
    x = np.arange(-15, 15, 0.01)
    T = stand(rough, np.column_stack([x, 0.3 * x]), np.full(len(x), np.arctan(0.3)), 4.5, 1.8)
    slope = np.hypot(*rough.normal_at(np.random.default_rng(0).uniform(-30, 30, (20000, 2)))[:, :2].T).max()
    assert np.abs(np.diff(T[:, 2, 3])).max() < 0.0105 * slope
    assert np.abs(np.diff(T[:, 2, 0])).max() < 2 * 0.0105 * slope / (4.5 * WHEELBASE)
