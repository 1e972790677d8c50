"""Sight from a scan against a plain loop over its points."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.messages import Scan
from datmo.messages.sight import AZIMUTH_STEP, ELEVATION_STEP, HIGHEST, LOWEST, cells
from datmo.sight import make_sight


def cloud(n=3000, seed=0):
    rng = np.random.default_rng(seed)
    azimuth, elevation = rng.uniform(-np.pi, np.pi, n), np.deg2rad(rng.uniform(-30, 8, n))
    r = rng.uniform(0.2, 80, n)
    flat = r * np.cos(elevation)
    return np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), r * np.sin(elevation)])


def test_cells_hold_the_nearest_and_farthest_return():
    points = cloud().astype(np.float32)
    points[::97] = np.nan
    points[5] = 0
    keep = np.arange(len(points)) % 7 != 0
    sight = make_sight(Scan(points=points), keep)
    rows, columns = round((HIGHEST - LOWEST) / ELEVATION_STEP), round(2 * np.pi / AZIMUTH_STEP)
    assert sight.near.shape == (rows, columns)
    near, far = np.zeros((rows, columns)), np.zeros((rows, columns))
    ok = keep & np.isfinite(points).all(1) & (np.linalg.norm(points, axis=1) >= 0.5)
    row, column = cells(points[ok].astype(float), (rows, columns))
    for p, i, j in zip(points[ok].astype(float), row, column, strict=True):
        if 0 <= i < rows:
            r = np.linalg.norm(p)
            near[i, j] = r if far[i, j] == 0 else min(near[i, j], r)
            far[i, j] = max(far[i, j], r)
    np.testing.assert_allclose(sight.near, near, rtol=1e-6)
    np.testing.assert_allclose(sight.far, far, rtol=1e-6)


def test_look_finds_what_was_put_there():
    T = np.eye(4)
    T[:3, 3] = [100, -50, 2]
    T[:2, :2] = [[0, -1], [1, 0]]
    sight = make_sight(
        Scan(points=[[10.0, 0.01, -0.5], [10.0, 0.02, -0.51], [30.0, 0.04, -1.5]], T_world_sensor=T)
    )
    ahead = np.array([[100, -30, 1.0]])
    distance, near, far = sight.look(ahead)
    assert distance[0] == pytest.approx(np.hypot(20, 1), rel=1e-6)
    assert near[0] == pytest.approx(10, abs=0.05)
    assert far[0] == pytest.approx(30, abs=0.1)
    assert np.isnan(sight.look(np.array([[100, -70, 1.0]]))[1][0])


def test_no_points_see_nothing():
    sight = make_sight(Scan(points=np.zeros((0, 3))))
    assert sight.far.max() == 0


def test_columns_tell_when_their_rays_were_fired():
    azimuth = np.deg2rad(np.array([10.1, 10.2, -170.2]))
    points = np.column_stack([20 * np.cos(azimuth), 20 * np.sin(azimuth), np.full(3, -1.0)])
    sight = make_sight(Scan(points=points, dt=[-0.04, -0.02, -0.09]))
    when = sight.when(np.array([[20 * np.cos(0.177), 20 * np.sin(0.177)], [-30.0, -5.2], [20.0, 0.0]]))
    np.testing.assert_allclose(when, [-0.03, -0.09, -0.03], atol=1e-6)  # the last from the nearest column
    assert make_sight(Scan(points=np.zeros((0, 3)))).when(np.array([[1.0, 0.0]])).tolist() == [0]
