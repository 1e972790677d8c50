"""Whether a method is better than Patchwork++ on every scene, by the rule that the project set itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from eval.benchmark.ground_grid import Row
from eval.benchmark.ground_peers import RIVAL
from eval.benchmark.ground_scenario import FLAT, rms_of

HARD_CLASSES = "DEFGH"
HARD_GRADE = 5.0
"""A scene is hard from this grade [%], or from class D or its rms height on."""
HARD_RMS = 0.03
MARGIN = 0.003
"""On the other scenes F1 may be this much below the rival's."""


@dataclass(frozen=True)
class Verdict:
    """How a method does against Patchwork++.

    Attributes:
        method: ours. hard, easy: scenes of either sort. won: hard ones with a better F1 and a
            smaller leak. held: easy ones with F1 within `MARGIN`. short: the other scenes.
    """

    method: str
    hard: int
    won: int
    easy: int
    held: int
    short: tuple[str, ...]

    def __str__(self) -> str:
        said = (
            f"{self.method}: better than {RIVAL} in F1 and in leak on {self.won} of {self.hard} hard scenes "
            f"(class D or rougher, or {HARD_GRADE:g} % or more), within {100 * MARGIN:g} of its F1 on "
            f"{self.held} of {self.easy} others"
        )
        return said + (f"; short on {', '.join(self.short)}" if self.short else "")


def is_hard(roughness: str, grade: float) -> bool:
    """Whether a scene is one where we must be better."""
    rms = rms_of(roughness)
    rough = roughness in HARD_CLASSES if rms is None else rms >= HARD_RMS
    return (rough and roughness != FLAT) or grade >= HARD_GRADE


def verdict(rows: Sequence[Row], method: str) -> Verdict | None:
    """The verdict on a method; None where the rival or the method has no rows.

    A scene without vehicles or persons has no leak, and is judged by F1 alone.
    """
    rival = {row.scene: row.figures for row in rows if row.method == RIVAL}
    counts, short = {True: [0, 0], False: [0, 0]}, []
    for row in rows:
        if row.method != method or row.scene not in rival:
            continue
        hard = is_hard(row.roughness, row.grade)
        met = _better(row, rival[row.scene]) if hard else _near(row, rival[row.scene])
        counts[hard][0] += 1
        counts[hard][1] += met
        if not met:
            short.append(row.scene)
    if not rival or not (counts[True][0] or counts[False][0]):
        return None
    (hard_ones, won), (easy_ones, held) = counts[True], counts[False]
    return Verdict(method, hard_ones, won, easy_ones, held, tuple(short))


def _better(row: Row, rival: dict[str, float | None]) -> bool:
    leak, other = row.figures["leak"], rival["leak"]
    tighter = leak is None or other is None or leak < other or leak == other == 0
    return tighter and (row.figures["f1"] or 0.0) > (rival["f1"] or 0.0)


def _near(row: Row, rival: dict[str, float | None]) -> bool:
    return (row.figures["f1"] or 0.0) >= (rival["f1"] or 0.0) - MARGIN
