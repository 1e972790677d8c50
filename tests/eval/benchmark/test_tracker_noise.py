"""The noise of detections fitted to samples of a known law."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.errors import ConfigError
from datmo.messages import Boxes, Kind
from eval.benchmark.kitti_tracks import Drive
from eval.benchmark.tracker_noise import Residuals, fit_noise, residuals


def sample(n=60_000, half=2.0, slope=0.9, doubt=2.0, std=(0.1, 0.05, 0.03)):
    rng = np.random.default_rng(0)
    score = rng.uniform(-3, 9, n)
    trust = 1 / (1 + np.exp(-slope * (score - half)))
    real = rng.random(n) < trust
    off = rng.normal(0, 1, (n, 3)) * std * (1 + doubt * np.sqrt(1 - trust))[:, None]
    off[~real] = np.nan
    return Residuals(score, real, off)


def test_the_law_is_found_again():
    noise = fit_noise(sample())
    assert noise.logit_half == pytest.approx(2.0, abs=0.1)
    assert noise.logit_slope == pytest.approx(0.9, rel=0.05)
    assert noise.doubt_noise == pytest.approx(2.0, rel=0.1)
    assert noise.given_std == pytest.approx((0.1, 0.05), rel=0.05)
    assert noise.yaw_std == pytest.approx(0.03, rel=0.05)


def test_residuals_are_along_and_across_the_truth():
    truth = Boxes(
        [[10, 0, 0], [30, 0, 0]], [[4, 2, 1.5]] * 2, [np.pi / 2, 0.0], id=[1, 2], kind=[Kind.CAR] * 2
    )
    found = Boxes(
        [[10.1, 0.2, 0], [60, 0, 0]], [[4, 2, 1.5]] * 2, [np.pi / 2 + np.pi + 0.02, 0.0], score=[5.0, 1.0]
    )
    got = residuals([Drive("0000", np.zeros(1), (found,), (truth,))])
    np.testing.assert_allclose(got.off[0], [0.2, -0.1, 0.02], atol=1e-9)
    assert np.isnan(got.off[1]).all()
    assert got.real.tolist() == [True, False]
    with pytest.raises(ConfigError, match="give more sequences"):
        fit_noise(got)
