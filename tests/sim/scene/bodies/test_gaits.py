from __future__ import annotations

import numpy as np
import pytest

from sim.scene import assets
from sim.scene.bodies import gait, person
from sim.scene.bodies.figure import SHANK, THIGH, ahead
from sim.scene.bodies.variety import Look, Variety

PHASES = assets.GAIT_PHASES


def ankle(way, cycle):
    """How far the left ankle is ahead of the hip, over height."""
    pose = way.pose(cycle)
    return float((THIGH * ahead(pose.hip) + SHANK * ahead(pose.hip - pose.knee))[0])


@pytest.mark.parametrize("variant", range(len(person.PERSONS)))
def test_a_walker_steps_with_both_feet_and_swings_arms_against_them(variant):
    made = [person.person(variant, p) for p in range(PHASES)]
    lengths = [float(np.ptp(s.vertices[:, 0])) for s in made]
    h = person.PERSONS[variant].height
    assert max(lengths) - min(lengths) > 0.15 * h
    for a, b in zip(made[:8], made[8:], strict=True):  # half a cycle on, left has become right
        mirrored = a.vertices * [1, -1, 1]
        assert sorted(np.round(mirrored[:, 2], 6)) == sorted(np.round(b.vertices[:, 2], 6))
        assert np.round(mirrored.min(0), 6) == pytest.approx(np.round(b.vertices.min(0), 6), abs=1e-5)
    for shell in made:
        assert shell.vertices[:, 2].min() == 0
        assert shell.vertices[:, 2].max() == pytest.approx(h, rel=0.035)
    assert person.person(variant, None).vertices[:, 2].max() == pytest.approx(h, rel=0.01)
    assert assets.stride(variant) == pytest.approx(0.83 * h)


@pytest.mark.parametrize(("name", "early", "late"), [("walk", 0.15, 0.45), ("run", 0.02, 0.29)])
def test_the_stance_foot_goes_back_as_fast_as_the_body_goes_on(name, early, late):
    """While it rests on the ground it slips by under a tenth of the stride."""
    way = gait.gait(name)
    gone = ankle(way, early) - ankle(way, late)
    assert gone == pytest.approx((late - early) * way.stride, abs=0.1 * way.stride)


@pytest.mark.parametrize("variant", range(len(person.PERSONS)))
def test_a_runner_flies_twice_in_a_cycle_and_a_walker_never(variant):
    lowest = [float(person.person(variant, p, "run").vertices[:, 2].min()) for p in range(PHASES)]
    flies = [gait.RUN.aloft(p / PHASES) > 0 for p in range(PHASES)]
    assert sum(flies) == 2
    for z, aloft in zip(lowest, flies, strict=True):
        assert (0.005 < z < 0.06) if aloft else z == 0
    assert not any(gait.WALK.aloft(c) for c in np.linspace(0, 1, 50))


@pytest.mark.parametrize("name", ["walk", "run"])
def test_the_pelvis_moves_smoothly_and_stays_over_one_place(name):
    """The crown rises and falls by under 7 % of the height; no phase is shifted against the next."""
    crowns = []
    for p in range(PHASES):
        v = assets.asset(assets.at_phase("pedestrian/0", p, name)).vertices
        crowns.append(v[v[:, 2].argmax()])
    ptp = np.ptp(crowns, axis=0)
    assert ptp[0] < 0.01
    assert ptp[2] < 0.07 * 1.76
    step = np.abs(np.diff([*crowns, crowns[0]], axis=0))[:, 2]
    assert step.max() < 0.04


def test_runners_lean_and_bend_their_elbows():
    for p in range(PHASES):
        pose = gait.RUN.pose(p / PHASES)
        assert np.radians(75) < pose.elbow < np.radians(110)
    walk, run = person.person(0, 0).vertices, person.person(0, 0, "run").vertices
    assert run[run[:, 2].argmax(), 0] - walk[walk[:, 2].argmax(), 0] > 0.05


def test_children_have_larger_heads_and_the_medians_of_growth_charts():
    """CDC growth charts 2000: 5th to 95th percentiles 1.06-1.25 m at six, 1.28-1.50 m at ten."""
    for variant, low, high in ((4, 1.06, 1.25), (5, 1.28, 1.50)):
        for seed in range(0, 32, 5):
            key = Look("pedestrian", variant, seed=seed)
            p = person.varied(variant, Variety(key))
            assert low < p.height < high
        assert person.PERSONS[variant].head > 1.1


def test_a_persons_box_is_about_as_large_as_kittis():
    """0.84 x 0.66 x 1.76 m on average, up to 1.09 x 0.89 x 1.96 m in its training sequences."""
    for key in ("pedestrian/0", "pedestrian/1", "pedestrian/6"):
        length, width, height = assets.asset(key).size
        assert 0.8 < length < 1.09
        assert 0.4 < width < 0.89
        assert 1.5 < height < 1.96
