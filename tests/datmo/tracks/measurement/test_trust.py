"""What a score says of a box."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.tracks import TrackerConfig
from datmo.tracks.measurement.trust import are_logits, evidence, noise_factor, trust

CONFIG = TrackerConfig()


def test_shares_say_nothing_and_logits_follow_their_law():
    assert not are_logits(np.array([0.0, 0.4, 1.0]))
    assert are_logits(np.array([0.5, 1.2]))
    assert are_logits(np.array([-0.1]))
    assert not are_logits(np.zeros(0))
    assert trust(np.array([0.1, 0.9]), False, CONFIG).tolist() == [1, 1]
    p = trust(np.array([CONFIG.logit_half, -1e9, 1e9]), True, CONFIG)
    assert p[0] == 0.5
    assert 0 < p[1] < 1e-8
    assert p[2] < 1


def test_noise_grows_with_doubt_and_evidence_with_trust():
    p = np.array([0.2, 0.5, 0.9, 1.0])
    assert (np.diff(noise_factor(p, CONFIG)) < 0).all()
    assert noise_factor(p, CONFIG)[-1] == 1
    assert evidence(p[:3]) == pytest.approx(-np.log(1 - p[:3]))
    assert evidence(p)[-1] == 0
    # evidence adds up to the probability that any of the boxes is real
    assert 1 - np.exp(-evidence(p[:3]).sum()) == pytest.approx(1 - 0.8 * 0.5 * 0.1)
