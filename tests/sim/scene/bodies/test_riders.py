from __future__ import annotations

import numpy as np
import pytest

from sim.scene import assets
from sim.scene.bodies import bicycle, rider
from sim.scene.bodies.figure import FOREARM, SHANK, THIGH, UPPER_ARM
from sim.scene.bodies.variety import Look, Variety

LIMITS = {  # KITTI's cyclists and two-wheelers' data sheets: length, width, height [m]
    "bicycle/0": ((1.6, 1.95), (0.5, 0.88), (1.6, 1.9)),
    "bicycle/1": ((1.6, 1.95), (0.5, 0.88), (1.6, 1.9)),
    "motorcycle/0": ((2.0, 2.25), (0.7, 0.95), (1.5, 1.8)),
    "motorcycle/1": ((1.7, 1.95), (0.6, 0.85), (1.5, 1.8)),
}


@pytest.mark.parametrize("key", LIMITS)
def test_two_wheelers_stand_on_both_tyres_and_have_plausible_sizes(key):
    for seed in range(0, 32, 6):
        a = assets.asset(f"{key}~{seed}")
        assert all(low < size < high for size, (low, high) in zip(a.size, LIMITS[key], strict=True))
        foot = a.vertices[a.vertices[:, 2] < 1e-3]
        assert (foot[:, 0].min(), foot[:, 0].max()) == pytest.approx((-0.6, 0.65), abs=0.2)
        assert np.abs(foot[:, 1]).max() < 0.1  # tyres only: no shoe reaches the ground
        assert len(a.triangles) < 3000


@pytest.mark.parametrize("seed", [0, 7, 21])
def test_pedals_turn_once_in_a_cycle_and_no_foot_touches_the_ground(seed):
    lows, size = [], assets.asset(f"bicycle/0~{seed}").size
    for phase in range(assets.GAIT_PHASES):
        a = assets.asset(f"bicycle/0/{phase}~{seed}")
        assert a.size == size
        out = a.vertices[(np.abs(a.vertices[:, 1]) > 0.1) & (a.vertices[:, 2] < 0.6)]
        left, right = out[out[:, 1] > 0], out[out[:, 1] < 0]
        lows.append((left[:, 2].min(), right[:, 2].min()))
    lows = np.array(lows)
    assert lows.min() > 0.05
    assert np.ptp(lows[:, 0]) == pytest.approx(2 * bicycle.CRANK, abs=0.03)
    assert lows[:, 1] == pytest.approx(np.roll(lows[:, 0], 8), abs=1e-5)


@pytest.mark.parametrize("variant", [0, 1])
@pytest.mark.parametrize("seed", [0, 3, 17, 30])
def test_riders_reach_their_pedals_and_grips(variant, seed):
    """No limb is longer than its segments, so that none was cut short of what it holds."""
    look = Look("bicycle", variant, seed=seed)
    b = bicycle.varied(variant, Variety(look))
    hip = bicycle._saddle(b)
    h = b.rider.scale
    for turn in np.linspace(0, 2 * np.pi, 32):
        foot = (b.bracket + bicycle.CRANK * np.cos(turn) + bicycle.ANKLE[0],
                bicycle.BRACKET - bicycle.CRANK * np.sin(turn) + bicycle.ANKLE[1])  # fmt: skip
        assert np.hypot(foot[0] - hip[0], foot[1] - hip[1]) < 0.985 * (THIGH + SHANK) * h
    shoulder = rider._bowed(np.array([0, 0.106 * h * b.rider.girth, 0.285 * h]), b.lean)
    grip = np.array([b.bar[0], b.bar[1], b.bar[2] + 0.03]) - [hip[0], 0, hip[1]]
    assert 0.7 < np.linalg.norm(grip - shoulder) / ((UPPER_ARM + FOREARM) * h) < 1.08  # a hand is 0.09 h


def test_a_limb_of_two_segments_meets_its_point():
    first, middle, d = rider.reach(0.4, 0.3, 0.5)
    assert (first, middle, d) == pytest.approx((np.arccos(0.8), np.pi / 2, 0.5))
    assert rider.reach(0.4, 0.3, 2.0)[2] < 0.7
