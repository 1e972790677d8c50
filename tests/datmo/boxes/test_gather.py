"""Points gathered by cluster against a list of rows for each; what is not finite is found."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.boxes.gather import first_bad, gather, heights

LABELS = st.lists(st.integers(-1, 4), max_size=40).map(lambda labels: np.array(labels, np.int32))


@settings(max_examples=60, deadline=None)
@given(LABELS)
def test_each_cluster_has_its_points_in_their_order(label):
    rng = np.random.default_rng(len(label))
    points, ground = rng.normal(size=(len(label), 3)), rng.normal(size=len(label))
    gathered, below, starts = gather(points, ground, label, 5)
    base, top, clearance = heights(gathered[:, 2], below, starts)
    assert len(gathered) == len(below) == starts[-1] == np.sum(label >= 0)
    for k in range(5):
        rows, part = np.flatnonzero(label == k), slice(starts[k], starts[k + 1])
        assert np.array_equal(gathered[part], points[rows])
        assert np.array_equal(below[part], ground[rows])
        assert base[k] == pytest.approx(ground[rows].mean() if len(rows) else 0)
        assert top[k] == (points[rows, 2].max() if len(rows) else 0)
        assert clearance[k] == ((points[rows, 2] - ground[rows]).min() if len(rows) else 0)


@settings(max_examples=100, deadline=None)
@given(LABELS, st.integers(0, 2**32 - 1))
def test_the_first_labelled_row_that_is_not_finite_is_named(label, seed):
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(len(label), 4))
    rows[rng.random(rows.shape) < 0.03] = rng.choice([np.nan, np.inf, -np.inf])
    bad = np.flatnonzero((label >= 0) & ~np.isfinite(rows).all(1))
    assert first_bad(rows[:, :3].copy(), rows[:, 3].copy(), label) == (bad[0] if len(bad) else -1)
