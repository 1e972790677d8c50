"""Association by name: nearest neighbour, PDA and JIPDA against brute force; JPDA against Stone Soup."""

from __future__ import annotations

from datetime import datetime
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stonesoup.dataassociator.probability import JPDA
from stonesoup.hypothesiser.probability import PDAHypothesiser
from stonesoup.models.measurement.linear import LinearGaussian
from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, RandomWalk
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.types.detection import Detection
from stonesoup.types.state import GaussianState
from stonesoup.types.track import Track
from stonesoup.updater.kalman import KalmanUpdater

from datmo.messages import Boxes
from datmo.tracks import Tracker, TrackerConfig
from datmo.tracks.association.associate import associate
from datmo.tracks.association.existence import given_existence
from datmo.tracks.association.jpda import marginals
from datmo.tracks.association.pda import Links
from datmo.tracks.measurement.pairs import Pairs

METHODS = ("jpda", "pda", "gnn", "jipda")
SEEDS = st.integers(0, 2**32 - 1)


def problem(seed, most=5):
    """Random pairs in random order, weights (p,), misses (t,) and the number of boxes."""
    rng = np.random.default_rng(seed)
    t, b = rng.integers(1, most + 1, 2)
    track, box = np.nonzero(rng.random((t, b)) < rng.uniform(0.2, 1))
    order = rng.permutation(len(track))
    return pairs_of(track[order], box[order]), rng.lognormal(-5, 3, len(track)), rng.uniform(0.1, 1, t), b


def pairs_of(track, box):
    n = len(track)
    zero = np.zeros(n)
    return Pairs(
        np.asarray(track, int), np.asarray(box, int), np.zeros((n, 2)), np.tile(np.eye(2), (n, 1, 1)),
        np.ones((n, 2)), zero, zero, zero, np.zeros((n, 2, 2), bool), zero, np.full(n, 3.0),
    )  # fmt: skip


def solve(pairs, weight, miss, boxes, **config):
    t = len(miss)
    S, at = np.tile(np.eye(2), (t, 1, 1)), np.zeros((t, 2))
    return associate(pairs, weight, miss, boxes, TrackerConfig(**config), S, at)


def table(pairs, values, t, b):
    out = np.zeros((t, b))
    out[pairs.track, pairs.box] = values
    return out


def events(W):
    """Every joint event: for each track a box or -1, no box twice."""
    t, b = W.shape
    for event in product(range(-1, b), repeat=t):
        given_boxes = [j for j in event if j >= 0]
        if len(set(given_boxes)) == len(given_boxes) and all(
            j < 0 or W[i, j] > 0 for i, j in enumerate(event)
        ):
            yield event


@settings(max_examples=30)
@given(SEEDS)
def test_probabilities_sum_to_one_whatever_the_method(seed):
    pairs, weight, miss, b = problem(seed, most=8)
    for name in METHODS:
        for clutter in ("poisson", "nonparametric"):
            links = solve(pairs, weight, miss, b, association=name, clutter=clutter)
            total = links.missed + np.bincount(pairs.track, weights=links.beta, minlength=len(miss))
            np.testing.assert_allclose(total, 1, atol=1e-12)
            assert links.beta.min(initial=0) >= 0
            assert links.missed.min() >= 0
            boxes = np.bincount(pairs.box, weights=links.beta, minlength=b)
            assert name == "pda" or boxes.max() <= 1 + 1e-12


@settings(max_examples=40)
@given(SEEDS)
def test_relabelling_permutes_the_result(seed):
    pairs, weight, miss, b = problem(seed)
    rng = np.random.default_rng(seed)
    tracks, boxes, rows = (rng.permutation(n) for n in (len(miss), b, len(pairs)))
    other = pairs_of(np.argsort(tracks)[pairs.track[rows]], np.argsort(boxes)[pairs.box[rows]])
    for name in METHODS:
        one = solve(pairs, weight, miss, b, association=name)
        two = solve(other, weight[rows], miss[tracks], b, association=name)
        np.testing.assert_allclose(two.beta, one.beta[rows], rtol=0, atol=1e-12)
        np.testing.assert_allclose(two.missed, one.missed[tracks], rtol=0, atol=1e-12)


@settings(max_examples=60)
@given(SEEDS)
def test_nearest_is_the_best_joint_event(seed):
    pairs, weight, miss, b = problem(seed)
    links = solve(pairs, weight, miss, b, association="gnn")
    W = table(pairs, weight / TrackerConfig().clutter_density, len(miss), b)
    best = max(events(W), key=lambda e: sum(np.log(miss[i] if j < 0 else W[i, j]) for i, j in enumerate(e)))
    want = np.zeros_like(W)
    for i, j in enumerate(best):
        want[i, j] = j >= 0
    np.testing.assert_array_equal(table(pairs, links.beta, len(miss), b), want)
    np.testing.assert_array_equal(links.missed, 1 - want.sum(1))


@settings(max_examples=40)
@given(SEEDS)
def test_pda_is_jpda_where_no_box_is_shared(seed):
    rng = np.random.default_rng(seed)
    track = np.sort(rng.integers(0, 4, 7))
    pairs, weight, miss = pairs_of(track, np.arange(7)), rng.lognormal(-5, 3, 7), rng.uniform(0.1, 1, 4)
    for clutter in ("poisson", "nonparametric"):
        one, two = (solve(pairs, weight, miss, 7, association=a, clutter=clutter) for a in ("pda", "jpda"))
        np.testing.assert_allclose(one.beta, two.beta, rtol=0, atol=1e-14)
        np.testing.assert_allclose(one.missed, two.missed, rtol=0, atol=1e-14)


def test_pda_shares_a_box_and_jpda_does_not():
    pairs, weight, miss = pairs_of([0, 1], [0, 0]), np.array([1.0, 1.0]), np.array([0.1, 0.1])
    assert solve(pairs, weight, miss, 1, association="pda").beta.sum() > 1.9
    assert solve(pairs, weight, miss, 1, association="jpda").beta.sum() < 1


def brute_jipda(W, prior, found):
    """Existence, beta given existence and missed given existence, event by event.

    Each track is absent, there and unseen, or there with one box: three cases, nothing left out.
    W: (t, b) P_D N(nu) / lambda of tracks that exist.
    """
    t, b = W.shape
    beta, unseen, total = np.zeros((t, b)), np.zeros(t), 0.0
    for event in product(range(-2, b), repeat=t):
        taken = [j for j in event if j >= 0]
        if len(set(taken)) < len(taken):
            continue
        weight = 1.0
        for i, j in enumerate(event):
            if j == -2:
                weight *= 1 - prior[i]
            else:
                weight *= prior[i] * (W[i, j] if j >= 0 else 1 - found[i])
        total += weight
        for i, j in enumerate(event):
            if j >= 0:
                beta[i, j] += weight
            elif j == -1:
                unseen[i] += weight
    existence = (unseen + beta.sum(1)) / total
    return existence, beta / total / existence[:, None], unseen / total / existence


def jipda(pairs, weight, prior, found, b):
    links = solve(pairs, prior[pairs.track] * weight, 1 - prior * found, b, association="jipda")
    return given_existence(links, pairs.track, prior, found)


@settings(max_examples=40)
@given(SEEDS)
def test_jipda_equals_brute_force_over_events_with_existence(seed):
    pairs, weight, _, b = problem(seed, most=4)
    rng = np.random.default_rng(seed)
    t = pairs.track.max(initial=0) + 1
    prior, found = rng.uniform(0.01, 1, t), rng.uniform(0.05, 0.99, t)
    links, existence = jipda(pairs, weight, prior, found, b)
    W = table(pairs, weight / TrackerConfig().clutter_density, t, b)
    want = brute_jipda(W, prior, found)
    np.testing.assert_allclose(existence, want[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(table(pairs, links.beta, t, b), want[1], rtol=0, atol=1e-10)
    np.testing.assert_allclose(links.missed, want[2], rtol=0, atol=1e-10)


@settings(max_examples=40)
@given(SEEDS)
def test_jipda_of_tracks_that_surely_exist_is_jpda(seed):
    pairs, weight, _, b = problem(seed)
    t = pairs.track.max(initial=0) + 1
    found = np.random.default_rng(seed).uniform(0.05, 0.99, t)
    joint = solve(pairs, weight, 1 - found, b, association="jpda")
    links, existence = jipda(pairs, weight, np.ones(t), found, b)
    np.testing.assert_array_equal(existence, 1)
    np.testing.assert_array_equal(links.beta, joint.beta)
    np.testing.assert_array_equal(links.missed, joint.missed)


def test_existence_of_a_lone_track_without_a_box():
    """Musicki's closed form: r (1 - P_D P_G) / (1 - r P_D P_G)."""
    none = np.zeros(0, int)
    links, existence = given_existence(
        Links(np.zeros(0), np.ones(1), 0), none, np.array([0.8]), np.array([0.9])
    )
    assert existence[0] == pytest.approx(0.8 * 0.1 / (1 - 0.72))
    assert links.missed[0] == pytest.approx(1)


STAMP = datetime(2024, 1, 1)
DENSITY, DETECT, GATE = 0.02, 0.85, 0.99


def stone_soup(mean, S, R, z):
    """Marginals (t, b + 1) of Stone Soup's JPDA for places mean (t, 2), S = P + R, at boxes z (b, 2)."""
    model = LinearGaussian(2, (0, 1), R)
    still = CombinedLinearGaussianTransitionModel([RandomWalk(0.0), RandomWalk(0.0)])
    hypothesiser = PDAHypothesiser(
        KalmanPredictor(still), KalmanUpdater(model), DENSITY, DETECT, GATE, include_all=False
    )
    tracks = [Track([GaussianState(m, C - R, timestamp=STAMP)]) for m, C in zip(mean, S, strict=True)]
    boxes = [Detection(place, timestamp=STAMP, measurement_model=model) for place in z]
    found = JPDA(hypothesiser).associate(set(tracks), set(boxes), STAMP)
    out = np.zeros((len(tracks), len(boxes) + 1))
    for i, track in enumerate(tracks):
        for hypothesis in found[track]:
            column = boxes.index(hypothesis.measurement) if hypothesis else len(boxes)
            out[i, column] = float(hypothesis.probability)
    return out


@pytest.mark.parametrize("seed", range(12))
def test_jpda_equals_stone_soups(seed):
    rng = np.random.default_rng(seed)
    t, b = rng.integers(1, 5, 2)
    mean, z = rng.normal(0, 1.0, (t, 2)), rng.normal(0, 1.5, (b, 2))
    A, R = rng.normal(0, 0.7, (t, 2, 2)), np.diag([0.1, 0.2])
    S = np.einsum("tij,tkj->tik", A, A) + 0.05 * np.eye(2) + R
    nu = z[None] - mean[:, None]
    distance = np.einsum("tbi,tij,tbj->tb", nu, np.linalg.inv(S), nu)
    N = np.exp(-0.5 * distance) / (2 * np.pi * np.sqrt(np.linalg.det(S)))[:, None]
    W = np.where(distance <= -2 * np.log(1 - GATE), DETECT * N / DENSITY, 0)
    got, cut = marginals(W, np.full(t, 1 - DETECT * GATE))
    assert cut == 0
    np.testing.assert_allclose(got, stone_soup(mean, S, R, z), rtol=0, atol=1e-10)


def drive(name, frames=30, lost_at=20, **config):
    """A car that goes straight and is not seen from frame `lost_at` on; its status in each frame."""
    tracker = Tracker(TrackerConfig(association=name, **config))
    for k in range(frames):
        box = Boxes([[k * 1.0, 0, 0]], [[4.5, 1.8, 1.5]], [0.0]) if k < lost_at else Boxes.empty()
        tracks = tracker.step(box, 0.1 * k)
        yield int(tracks.status[0]) if len(tracks) else 0


@pytest.mark.parametrize("name", METHODS)
def test_every_method_tracks_and_lets_go(name):
    seen = list(drive(name))
    assert seen[:4] == [1, 2, 3, 4]
    assert set(seen[4:20]) == {5}
    assert seen[20] >= 6
    assert seen[-1] == 0


def test_jipda_lives_longer_where_less_is_expected_to_be_seen():
    lives = [sum(s > 5 for s in drive("jipda", 60, detection_prob=p)) for p in (0.95, 0.9, 0.5)]
    assert lives[0] < lives[1] < lives[2]
    assert sum(s > 5 for s in drive("jipda", 60, survival_time=0.05)) < lives[1]


def test_existence_must_have_room():
    with pytest.raises(ValueError, match="born_existence"):
        TrackerConfig(born_existence=0.01, dead_existence=0.5)
