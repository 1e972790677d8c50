"""The ground benchmark itself: every contestant on every scene, in turn, in one process."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from datmo.arrays import F64
from datmo.errors import ConfigError
from datmo.messages import Ground, Scan
from eval.benchmark.ground_figures import Figures, figures
from eval.benchmark.ground_methods import Contestant
from eval.benchmark.ground_peers import RIVAL
from eval.benchmark.ground_scenes import Scene
from eval.metrics.ratio import mean


@dataclass(frozen=True)
class Row:
    """What one contestant reached on one scene.

    Attributes:
        scene, roughness, grade: of the scene. method: the contestant. figures: by `NAMES`.
    """

    scene: str
    roughness: str
    grade: float
    method: str
    figures: Figures


def in_turn(contestants: Sequence[Contestant], scan: Scan, rounds: int) -> tuple[list[Ground], F64]:
    """Each contestant's result on a scan that it meets first, and its times (rounds + 1, c) [ms].

    Row 0 of the times is that first meeting; then each goes on with the same scan, as a sequence.
    """
    steps = [contestant.fresh() for contestant in contestants]
    times, grounds = np.zeros((rounds + 1, len(steps))), []
    for k in range(rounds + 1):
        for i, step in enumerate(steps):
            start = perf_counter()
            ground = step(scan)
            times[k, i] = (perf_counter() - start) * 1e3
            if k == 0:
                grounds.append(ground)
    return grounds, times


def time_figures(times: F64, i: int, rival: int | None) -> Figures:
    """Medians of contestant i's times over the rounds after the first."""
    ratio = None if rival is None else float(np.median(times[1:, i] / times[1:, rival]))
    return {"ms": float(np.median(times[1:, i])), "ms_first": float(times[0, i]), "ratio": ratio}


def rival_of(contestants: Sequence[Contestant]) -> int | None:
    """Which contestant is Patchwork++; None where it does not take part."""
    return next((i for i, c in enumerate(contestants) if c.name == RIVAL), None)


def play(contestants: Sequence[Contestant], scenes: Iterable[Scene], rounds: int = 5) -> list[Row]:
    """A row for each scene and contestant.

    Args:
        rounds: after the first meeting, over which times are medians.

    Raises:
        ConfigError: no round.
    """
    if rounds < 1:
        raise ConfigError(f"rounds is {rounds}; times are medians of at least 1; give 1 or more")
    rows, rival = [], rival_of(contestants)
    for number, scene in enumerate(scenes):
        if number == 0:
            in_turn(contestants, scene.scan, 1)  # compiles what is not yet compiled
        grounds, times = in_turn(contestants, scene.scan, rounds)
        for i, (contestant, ground) in enumerate(zip(contestants, grounds, strict=True)):
            found = figures(scene.scan, ground, scene.truth, scene.relief, contestant.ours)
            found |= time_figures(times, i, rival)
            rows.append(Row(scene.name, scene.roughness, scene.grade, contestant.name, found))
    return rows


def mean_figure(rows: Iterable[Row], name: str) -> float | None:
    """Mean of a figure over the rows that have it."""
    return mean([v for row in rows if (v := row.figures[name]) is not None])


def methods_of(rows: Iterable[Row]) -> list[str]:
    """The contestants of rows, in their order."""
    return list(dict.fromkeys(row.method for row in rows))
