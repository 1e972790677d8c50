"""Exact marginals against brute force over all joint events."""

from __future__ import annotations

from math import factorial

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from datmo.tracks.association.associate import associate, clutter_weights, groups
from datmo.tracks.association.jpda import marginals
from datmo.tracks.association.pda import pda, unassigned
from datmo.tracks.config import TrackerConfig
from datmo.tracks.measurement.pairs import Pairs


def brute(W, miss, phi=None):
    """Sum over every joint event, one after another."""
    r, c = W.shape
    out = np.zeros((r, c + 1))

    def go(i, used, weight, event):
        if i == r:
            weight = weight * (1 if phi is None else phi[len(used)])
            for t, j in enumerate(event):
                out[t, j] += weight
            return
        go(i + 1, used, weight * miss[i], [*event, c])
        for j in range(c):
            if W[i, j] > 0 and j not in used:
                go(i + 1, used | {j}, weight * W[i, j], [*event, j])

    go(0, frozenset(), 1.0, [])
    return out / out.sum(1, keepdims=True)


@pytest.mark.parametrize("seed", range(60))
@pytest.mark.parametrize("counted", [False, True])
def test_marginals_equal_brute_force(seed, counted):
    rng = np.random.default_rng(seed)
    r, c = rng.integers(1, 7, 2)
    W = rng.lognormal(0, 3, (r, c)) * (rng.random((r, c)) < rng.uniform(0.2, 1))
    miss = rng.uniform(0.01, 1, r)
    phi = clutter_weights(c, min(r, c), 7.3) if counted else None
    got, cut = marginals(W, miss, phi)
    assert cut == 0
    np.testing.assert_allclose(got, brute(W, miss, phi), rtol=0, atol=1e-10)
    np.testing.assert_allclose(got.sum(1), 1, atol=1e-12)


def test_clutter_weights_are_the_printed_ones():
    got = clutter_weights(4, 3, 2.5)
    want = np.array([factorial(p) / 2.5**p for p in (4, 3, 2, 1)])
    np.testing.assert_allclose(got / got[0], want / want[0], rtol=1e-12)


def test_a_long_chain_stays_cheap_and_equals_its_halves():
    """40 tracks in a row, each sharing a box with the next: the frontier is two, not forty."""
    n = 40
    rng = np.random.default_rng(0)
    W = np.zeros((n, n + 1))
    for i in range(n):
        W[i, [i, i + 1]] = rng.lognormal(0, 1, 2)
    got, cut = marginals(W, np.full(n, 0.1), max_bits=4)
    assert cut == 0
    # the transfer-matrix form of a chain, written out
    prefix = np.zeros((n + 1, 2))
    prefix[0] = [1, 0]
    for i in range(n):
        free, taken = prefix[i]
        prefix[i + 1] = [(free + taken) * 0.1 + free * W[i, i], (free + taken) * W[i, i + 1]]
    suffix = np.ones((n + 1, 2))
    for i in range(n - 1, -1, -1):
        for s in (0, 1):
            keep = 0.1 + (W[i, i] if s == 0 else 0)
            suffix[i, s] = keep * suffix[i + 1, 0] + W[i, i + 1] * suffix[i + 1, 1]
    total = prefix[n].sum()
    k = n // 2
    takes_next = prefix[k].sum() * W[k, k + 1] * suffix[k + 1, 1] / total
    assert got[k, k + 1] == pytest.approx(takes_next, rel=1e-10)


def test_a_pile_up_beyond_the_bound_is_cut_and_says_so():
    rng = np.random.default_rng(1)
    W, miss = rng.lognormal(0, 2, (9, 9)), np.full(9, 0.1)
    exact, none = marginals(W, miss)
    bounded, cut = marginals(W, miss, max_bits=6)
    assert none == 0
    assert cut > 0
    np.testing.assert_allclose(bounded.sum(1), 1, atol=1e-12)
    assert np.abs(bounded - exact).max() < 0.25


def test_equal_links_are_cut_evenly():
    """Sixteen tracks and sixteen boxes that nothing tells apart: nobody is left without."""
    got, cut = marginals(np.ones((16, 16)), np.full(16, 0.1))
    assert 0 < cut < 160
    assert got[:, :16].sum(1).min() > 0.8
    assert got[:, :16].sum(0).min() > 0.8


def test_the_counted_form_is_bounded_in_memory_too():
    """Forty tracks, each with twelve boxes that the next ones share, and a weight for each count."""
    n = 40
    rng = np.random.default_rng(4)
    W = np.zeros((n, n + 11))
    for i in range(n):
        W[i, i : i + 12] = rng.lognormal(0, 1, 12)
    phi = clutter_weights(n + 11, n, 50.0)
    got, cut = marginals(W, np.full(n, 0.1), phi)
    assert cut > 0
    assert marginals(W, np.full(n, 0.1))[1] == 0
    np.testing.assert_allclose(got.sum(1), 1, atol=1e-12)


def test_relabelling_changes_nothing():
    rng = np.random.default_rng(2)
    W, miss = rng.lognormal(0, 2, (5, 6)), rng.uniform(0.1, 1, 5)
    rows, columns = rng.permutation(5), rng.permutation(6)
    a, _ = marginals(W, miss)
    b, _ = marginals(W[rows][:, columns], miss[rows])
    np.testing.assert_allclose(b, a[rows][:, [*columns, 6]], atol=1e-12)


def some_pairs(track, box, volume=3.0):
    n = len(track)
    zero = np.zeros(n)
    return Pairs(
        np.array(track), np.array(box), np.zeros((n, 2)), np.tile(np.eye(2), (n, 1, 1)), np.ones((n, 2)),
        zero, zero, zero, np.zeros((n, 2, 2), bool), zero, np.full(n, volume),
    )  # fmt: skip


@pytest.mark.parametrize("clutter", ["poisson", "nonparametric"])
def test_one_track_alone_equals_pda(clutter):
    """The closed form used for lone tracks, the event sum, and method.md's b and e."""
    config = TrackerConfig(clutter=clutter)
    rng = np.random.default_rng(3)
    S, eta = np.array([[0.5, 0.1], [0.1, 0.3]]), config.gate_chi2
    nu = rng.multivariate_normal([0, 0], S, 3)
    e = np.exp(-0.5 * np.einsum("ni,ij,nj->n", nu, np.linalg.inv(S), nu))
    root = np.sqrt(np.linalg.det(S))
    detect, volume = 0.9, np.pi * eta * root
    miss = 1 - detect * config.gate_prob
    if clutter == "nonparametric":
        b = (2 * np.pi / eta) * 3 * miss / (np.pi * detect)
    else:
        b = 2 * np.pi * root * config.clutter_density * miss / detect
    weight = detect * e / (2 * np.pi * root)
    pairs = some_pairs([0, 0, 0], [0, 1, 2], volume)
    links = associate(pairs, weight, np.array([miss]), 3, config, S[None], np.zeros((1, 2)))
    np.testing.assert_allclose(links.beta, e / (b + e.sum()), atol=1e-12)
    assert links.missed[0] == pytest.approx(b / (b + e.sum()), abs=1e-12)
    phi = clutter_weights(3, 1, volume) if clutter == "nonparametric" else None
    scaled = weight if phi is not None else weight / config.clutter_density
    events = brute(scaled[None], np.array([miss]), phi)
    np.testing.assert_allclose(events[0, :3], links.beta, atol=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_groups_are_the_connected_components(seed):
    """Against SciPy's graph search, on random links."""
    rng = np.random.default_rng(seed)
    tracks, boxes, count = 12, 10, int(rng.integers(0, 25))
    link = np.unique(rng.integers(0, tracks * boxes, count))
    pairs = some_pairs(link // boxes, link % boxes)
    alone, crowds = groups(pairs, tracks, boxes)
    ends = link // boxes, tracks + link % boxes
    graph = coo_array((np.ones(len(link)), ends), shape=(tracks + boxes, tracks + boxes))
    label = connected_components(graph, directed=False)[1]
    shared = {k for k in label if len({t for t in ends[0] if label[t] == k}) > 1}
    assert sorted(alone) == [p for p, t in enumerate(ends[0]) if label[t] not in shared]
    wanted = [[p for p, t in enumerate(ends[0]) if label[t] == k] for k in shared]
    assert sorted(rows.tolist() for rows in crowds) == sorted(wanted)


def test_groups_are_independent():
    """Tracks 0 and 1 share box 1; track 2 is alone with box 2; the whole equals the parts."""
    config = TrackerConfig()
    pairs = some_pairs([0, 0, 1, 2], [0, 1, 1, 2])
    weight, miss = np.array([0.2, 0.4, 0.7, 0.3]), np.array([0.1, 0.2, 0.3])
    alone, crowds = groups(pairs, 3, 3)
    assert alone.tolist() == [3]
    assert [c.tolist() for c in crowds] == [[0, 1, 2]]
    links = associate(pairs, weight, miss, 3, config, np.tile(np.eye(2), (3, 1, 1)), np.zeros((3, 2)))
    W = np.zeros((3, 3))
    W[pairs.track, pairs.box] = weight / config.clutter_density
    whole = brute(W, miss)
    np.testing.assert_allclose(links.beta, whole[pairs.track, pairs.box], atol=1e-12)
    np.testing.assert_allclose(links.missed, whole[:, 3], atol=1e-12)


def test_tracks_without_a_box_are_missed():
    none = some_pairs([0], [0]).select(np.zeros(0, int))
    beta, missed = pda(none, np.zeros(0), unassigned(none, np.ones(2), TrackerConfig()))
    assert len(beta) == 0
    assert missed.tolist() == [1, 1]
