"""Disjoint sets against SciPy's graph search."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from datmo.union_find import join


@pytest.mark.parametrize("seed", range(10))
def test_what_is_joined_has_one_root_the_lowest_of_its_set(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.integers(0, 40, (2, 25))
    parent = np.arange(40)
    for pair in zip(a, b, strict=True):
        join(parent, *pair)
    roots = [root(parent, k) for k in range(40)]
    label = connected_components(coo_array((np.ones(25), (a, b)), shape=(40, 40)), directed=False)[1]
    assert roots == [int(np.flatnonzero(label == k)[0]) for k in label]


def root(parent, k):
    return k if parent[k] == k else root(parent, parent[k])
