"""Times of the tracker: what is timed is what it says."""

from __future__ import annotations

import numpy as np

from eval.benchmark.stone_soup import ROUNDS, joint_association
from eval.benchmark.tracker_speed import WARM_UP, Times, cars, filters, ours, speed_table


def test_the_cars_are_tracked_and_every_step_is_timed():
    scans = cars(6, 2, WARM_UP + 5, 12.0)
    assert all(len(a.center) >= 2 for a in scans)
    again = cars(6, 2, WARM_UP + 5, 12.0)
    assert all(a == b for a, b in zip(scans, again, strict=True))
    whole = ours("whole", scans)
    assert len(whole.steps) == 5
    assert whole.tracks >= 5
    for engine in ("batched", "filterpy"):
        alone = filters("alone", engine, scans)
        assert alone.tracks == whole.tracks
        assert (alone.steps > 0).all()


def test_stone_soup_is_timed_and_the_table_tells_what_was_asked():
    assert (joint_association(*cars(4, 1, 2, 12.0)) > 0).all()
    assert len(joint_association(*cars(2, 0, 2, 12.0))) == ROUNDS
    rows = speed_table(
        [Times("100 tracks", np.array([1.0, 2.0, 9.0]), 100), Times("other", np.ones(3), 4)]
    ).rows
    assert rows[0] == ("100 tracks", "2.00", "8.86", "10 / -", "100")
    assert rows[1][3] == "- / -"
