from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from datmo.messages import Clusters
from eval.metrics.detection import Matched
from eval.metrics.diagnosis import Diagnosis, Stage, diagnose


def diagnosed(
    make: Any, parts: list[tuple[int, int, int, bool]], found: list[bool], notes: dict[str, str] | None = None
) -> Diagnosis:
    """Parts are (actor, cluster, returns, called ground); actor -1 is a thing."""
    actor = np.concatenate([np.full(n, a) for a, _, n, _ in parts])
    label = np.concatenate([np.full(n, c) for _, c, n, _ in parts])
    ground = np.concatenate([np.full(n, g) for _, _, n, g in parts])
    k = len(found)
    frame = dataclasses.replace(
        make.frame(points=np.zeros((len(actor), 3)), is_ground=ground),
        clusters=Clusters(label, int(label.max()) + 1),
        notes=notes or {},
    )
    returns = np.bincount(actor[actor >= 0], minlength=k)
    truth = make.truth(
        make.boxes(20.0 * np.arange(k)[:, None] * [1, 0]),
        returns=returns,
        actor=actor,
        thing=np.where(actor < 0, 7, -1),
    )
    none = np.zeros(0, bool)
    return diagnose(frame, truth, Matched(none.astype(int), none, none, returns >= 5, np.array(found, bool)))


def test_a_whole_object_is_neither_split_nor_merged(make: Any) -> None:
    got = diagnosed(make, [(0, 0, 40, False), (0, -1, 30, True), (-1, 1, 99, False)], [True])
    assert (got.judged.tolist(), got.main.tolist()) == ([True], [0])
    assert (got.split.tolist(), got.merged.tolist(), got.stage.tolist()) == ([False], [False], [Stage.NONE])


@pytest.mark.parametrize(("second", "split"), [(9, False), (10, True), (40, True)])
def test_split_from_a_fifth_of_its_clustered_returns_on(make: Any, second: int, split: bool) -> None:
    got = diagnosed(make, [(0, 3, 50 - second, False), (0, 1, second, False), (0, -1, 99, False)], [True])
    assert got.split.tolist() == [split]


def test_four_returns_are_no_part(make: Any) -> None:
    assert not diagnosed(make, [(0, 0, 7, False), (0, 1, 4, False)], [True]).split[0]


def test_merged_with_another_object_or_with_things(make: Any) -> None:
    got = diagnosed(
        make,
        [(0, 0, 30, False), (1, 0, 20, False), (2, 1, 20, False), (-1, 1, 21, False), (3, 2, 20, False)],
        [True, False, False, True],
    )
    assert got.merged.tolist() == [True, True, True, False]
    assert got.stage.tolist() == [Stage.NONE, Stage.CLUSTERS, Stage.CLUSTERS, Stage.NONE]


def test_an_object_of_few_returns_is_not_judged_and_merges_nobody(make: Any) -> None:
    got = diagnosed(make, [(0, 0, 30, False), (1, 0, 9, False)], [True, False])
    assert got.judged.tolist() == [True, False]
    assert got.merged.tolist() == [False, False]


def test_the_stage_that_lost_it(make: Any) -> None:
    parts = [
        (0, -1, 21, True), (0, 0, 19, False),  # most of it is ground
        (1, -1, 20, False), (1, 1, 4, False),  # hardly clustered
        (2, 2, 20, False),  # refused
        (3, 3, 20, False),  # its box lies elsewhere
    ]  # fmt: skip
    got = diagnosed(make, parts, [False] * 4, {"cluster 2": "cluster 2: height 0.2 < 0.5"})
    assert got.stage.tolist() == [Stage.GROUND, Stage.CLUSTERS, Stage.RULES, Stage.BOXES]


def test_no_clusters_and_no_objects(make: Any) -> None:
    got = diagnosed(make, [(0, -1, 30, False)], [False])
    assert (got.main.tolist(), got.stage.tolist()) == ([-1], [Stage.CLUSTERS])
    assert len(diagnosed(make, [(-1, 0, 3, False)], []).stage) == 0


@pytest.mark.parametrize("seed", range(20))
def test_counts_agree_with_plain_loops(make: Any, seed: int) -> None:
    rng = np.random.default_rng(seed)
    k, c = 5, 6
    parts = [
        (int(rng.integers(-1, k)), int(rng.integers(-1, c)), int(rng.integers(1, 25)), False)
        for _ in range(30)
    ]
    got = diagnosed(make, parts, [True] * k)
    held = {
        (a, b): sum(n for x, y, n, _ in parts if (x, y) == (a, b)) for a in range(-1, k) for b in range(c)
    }
    total = [sum(n for x, _, n, _ in parts if x == a) for a in range(k)]
    main = [
        max(range(c), key=lambda b: (held[a, b], -b)) if any(held[a, b] for b in range(c)) else -1
        for a in range(k)
    ]
    sure = [total[a] >= 10 and main[a] >= 0 and held[a, main[a]] >= 5 for a in range(k)]
    for a in range(k):
        others = [held[a, b] for b in range(c) if b != main[a]]
        clustered = sum(held[a, b] for b in range(c))
        assert got.judged[a] == (total[a] >= 10)
        assert got.main[a] == main[a]
        assert got.split[a] == (got.judged[a] and max(others) >= 5 and max(others) >= 0.2 * clustered)
        if main[a] >= 0:
            rivals = [o for o in range(k) if o != a and sure[o] and main[o] == main[a]]
            assert got.merged[a] == (got.judged[a] and bool(rivals or held[-1, main[a]] > held[a, main[a]]))
