from __future__ import annotations

import numpy as np

from datmo.messages import Boxes, LostRays, Truth, visibility
from scenarios.load import load
from sim.env import LidarEnv
from sim.hidden import Hidden, HiddenIntervals


def truth_at(stamp: float, ids: list[int], visible: list[int]) -> Truth:
    """Objects with 100 solo rays (0 where `visible` is negative: out of range)."""
    k = len(ids)
    won = np.maximum(visible, 0)
    solo = np.where(np.array(visible) < 0, 0, 100)
    return Truth(
        boxes=Boxes(center=np.zeros((k, 3)), size=np.ones((k, 3)), yaw=np.zeros(k), id=np.array(ids)),
        stamp=stamp,
        T_world_actor=np.broadcast_to(np.eye(4), (k, 4, 4)),
        actor=np.zeros(0),
        thing=np.zeros(0),
        kind=np.zeros(0),
        is_ground=np.zeros(0, bool),
        height=np.zeros(0),
        normal=np.zeros((0, 3)),
        solo=solo,
        visible=won,
        returns=won,
        lost_to=np.zeros((k, k + 2)),
        visibility=visibility(solo, won),
        lost=LostRays(*(np.zeros(0) for _ in range(6))),
    )


def test_intervals_begin_and_end_with_the_scans_that_show_it() -> None:
    record = HiddenIntervals()
    seen = [(9, 50), (0, 50), (4, 0), (5, 0), (2, 50)]
    for k, counts in enumerate(seen):
        record.add(truth_at(k / 10, [7, 8], list(counts)))
    assert record.intervals() == (
        Hidden(7, 0.1, 0.3),
        Hidden(8, 0.2, 0.4),
        Hidden(7, 0.4, None),
    )


def test_leaving_range_or_world_ends_an_interval() -> None:
    record = HiddenIntervals()
    record.add(truth_at(0.0, [1, 2], [0, 0]))
    record.add(truth_at(0.1, [1], [-1]))
    assert record.intervals() == (Hidden(1, 0.0, 0.1), Hidden(2, 0.0, 0.1))


def test_nobody_hidden() -> None:
    record = HiddenIntervals()
    record.add(truth_at(0.0, [1], [60]))
    assert record.intervals() == ()


def test_the_environment_knows_its_hidden_intervals() -> None:
    env = LidarEnv(load("rough-crossing", {"terrain.cell": "1.0", "duration": "3"}))
    truths = [env.reset(seed=0)[1]["truth"]]
    while len(truths) < 20:
        truths.append(env.step(0)[4]["truth"])
    record = HiddenIntervals()
    for truth in truths:
        record.add(truth)
    assert env.hidden_intervals == record.intervals()
    env.reset(seed=1)
    assert all(i.start == 0.0 for i in env.hidden_intervals)
