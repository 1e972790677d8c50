from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from datmo.messages import Scan
from datmo.refine import RefineConfig, distances, mean_and_std, refine, rings_of


def ring_cloud(rings: int = 8, columns: int = 360) -> Scan:
    """Rings on a wall at 10 m, anticlockwise from the x axis as KITTI stores them."""
    azimuth = (np.arange(columns) + 0.5) * 2 * np.pi / columns
    points = [
        np.column_stack([10 * np.cos(azimuth), 10 * np.sin(azimuth), np.full(columns, -k / 5)])
        for k in range(rings)
    ]
    return Scan(points=np.concatenate(points), ring=np.repeat(np.arange(rings), columns))


def test_each_rule_drops_its_points() -> None:
    scan = ring_cloud()
    points = scan.points.copy()
    points[0] = np.nan
    points[5, 2] = np.inf
    points[10] *= 20
    points[15] *= 0.01
    points[20] *= 3
    keep = refine(Scan(points=points, ring=scan.ring), RefineConfig(radius=80, blind=0.9))
    assert np.flatnonzero(~keep).tolist() == [0, 5, 10, 15, 20]
    without = refine(Scan(points=points, ring=scan.ring), RefineConfig(neighbours=0))
    assert np.flatnonzero(~without).tolist() == [0, 5, 10, 15]


def test_rings_are_told_by_the_order_where_they_are_not_given() -> None:
    scan = ring_cloud()
    assert np.array_equal(rings_of(scan.points), scan.ring)
    points = scan.points.copy()
    points[700] *= 3
    given, derived = refine(Scan(points=points, ring=scan.ring)), refine(Scan(points=points))
    assert np.array_equal(given, derived)
    assert np.flatnonzero(~given).tolist() == [700]


def broken(seed: int) -> np.ndarray:
    """The ring cloud with gaps, turned about z, some of its points at the sensor or not finite."""
    rng = np.random.default_rng(seed)
    points = ring_cloud(6, 60).points.copy()
    points[:, :2] = np.roll(points[:, :2], rng.integers(0, 60), axis=0)
    points *= rng.uniform(0.9, 1.1, (len(points), 1))
    for value in (0.0, np.nan, np.inf):
        points[rng.random(len(points)) < 0.03] = value
    return points[rng.random(len(points)) < rng.uniform(0.02, 1)].astype(np.float32)


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_a_ring_ends_where_the_azimuth_falls_by_more_than_half_a_turn(seed: int) -> None:
    points, expected, last, now = broken(seed), [], 0.0, 0
    for x, y, _ in points.astype(float):
        if np.isfinite(x) and (x, y) != (0, 0):
            azimuth = np.arctan2(y, x) % (2 * np.pi)
            now, last = now + (last - azimuth > np.pi), azimuth
        expected.append(now)
    assert rings_of(points).tolist() == expected


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.integers(1, 4))
def test_distances_are_those_of_a_plain_loop(seed: int, side: int) -> None:
    rng, points = np.random.default_rng(seed), broken(seed)
    keep = np.isfinite(points).all(1) & (rng.random(len(points)) < 0.9)
    ring, at = rng.integers(0, 2, len(points)).astype(np.int32), np.flatnonzero(keep)
    expected = np.full(len(points), np.nan)
    for k, i in enumerate(at):
        beside = [j for j in at[max(k - side, 0) : k + side + 1] if j != i and ring[j] == ring[i]]
        if beside:
            nearest = np.linalg.norm(points[beside] - points[i], axis=1).min()
            expected[i] = nearest / np.maximum(np.linalg.norm(points[i]), 1e-6)
    got = distances(points, ring, keep, side)
    np.testing.assert_allclose(got, expected, rtol=1e-5, atol=1e-30)
    mean, std = mean_and_std(got)
    if np.isfinite(got).any():
        known = got[~np.isnan(got)].astype(float)
        assert (mean, std) == pytest.approx((known.mean(), known.std()), rel=1e-9, abs=1e-12)
    else:
        assert np.isnan([mean, std]).all()


def test_distances_are_those_of_a_tree_where_the_nearest_is_adjacent() -> None:
    rng = np.random.default_rng(1)
    scan = ring_cloud()
    points = scan.points * rng.uniform(0.98, 1.02, (len(scan), 1)).astype(np.float32)
    far = rng.random(len(points)) < 0.02
    points[far] *= 2
    keep = np.ones(len(points), bool)
    ours = distances(points, scan.ring.astype(np.int32), keep, 8)
    for k in range(8):
        row = np.flatnonzero(scan.ring == k)[10:-10]
        tree = cKDTree(points[scan.ring == k]).query(points[row], 2)[0][:, 1]
        near = ~far[row]
        norm = np.linalg.norm(points[row], axis=1)
        assert np.allclose(ours[row][near], (tree / norm)[near], rtol=1e-4)
        assert (ours[row] >= tree / norm - 1e-5).all()


def test_agrees_with_the_statistical_filter_of_a_tree_on_lone_returns() -> None:
    rng = np.random.default_rng(2)
    scan = ring_cloud()
    points = scan.points.copy()
    lone = np.arange(50, 2800, 97)
    points[lone] = points[lone] * rng.uniform(2, 4, (len(lone), 1))
    nearest = cKDTree(points).query(points, 2)[0][:, 1]
    tree = nearest > nearest.mean() + 3 * nearest.std()
    ours = ~refine(Scan(points=points, ring=scan.ring), RefineConfig(deviations=3))
    assert ours[lone].all()
    assert not ours[np.setdiff1d(np.arange(len(points)), lone)].any()
    assert (ours | ~tree).all()


@pytest.mark.parametrize(
    "points", [np.zeros((0, 3)), np.zeros((1, 3)), np.full((4, 3), np.nan), np.ones((5, 3))]
)
def test_degenerate_clouds(points: np.ndarray) -> None:
    keep = refine(Scan(points=points))
    fine = np.isfinite(points).all(1) & (np.linalg.norm(points, axis=1) >= 0.9)
    assert np.array_equal(keep, fine)
