"""The thesis's Table 5.1 anew: does a learned latent length-scale (Z-L) beat lines (Z)?

The thesis scored on the candidates that it had trained on. Here the error is that against the true
ground, at the centres of the fixed grid which hold ground returns.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np
from scipy.stats import binomtest

from datmo.arrays import F64, Array
from datmo.errors import ConfigError
from datmo.ground import METHODS, GroundConfig, GroundSegmenter
from eval.benchmark.ground_figures import height_figures
from eval.benchmark.ground_methods import check_methods
from eval.benchmark.ground_scenes import Scene
from eval.benchmark.table import Rows, say

WANTED = ("z", "zl", "zli")
DRAWS, LEVEL = 10_000, 0.95
"""Bootstrap samples of the frames, and the share of them that the interval holds."""


@dataclass(frozen=True)
class Line:
    """One frame and method of the table.

    Attributes:
        scene, method: which. candidates, supports: n_PG and n_L, medians over the segments that have
            candidates; None where a method has none or does not tell. ms_first, ms: time of the first
            scan, and median of those that go on from it [ms]. hyper: learned, by the symbol of
            method.md. smse: against the true ground, seen; None where that is flat. rmse: [m].
        rmse_unseen: [m].
    """

    scene: str
    method: str
    candidates: float | None
    supports: float | None
    ms_first: float
    ms: float
    smse: float | None
    rmse: float | None
    rmse_unseen: float | None
    hyper: dict[str, float] = field(default_factory=dict)


def methods_there() -> list[str]:
    """Which of the thesis's methods this version has."""
    return [name for name in WANTED if name in METHODS]


def table51(methods: Sequence[str], scenes: Iterable[Scene], rounds: int = 5) -> list[Line]:
    """A line for each scene and method; times interleaved.

    Raises:
        ConfigError: an unknown method, or no round.
    """
    check_methods(methods)
    if rounds < 1:
        raise ConfigError(f"rounds is {rounds}; times are medians of at least 1; give 1 or more")
    lines = []
    for number, scene in enumerate(scenes):
        if number == 0:
            for method in methods:  # compiles what is not yet compiled
                _segmenter(method).step(scene.scan.points)
        lines += _frame(methods, scene, rounds)
    return lines


def _segmenter(method: str) -> GroundSegmenter:
    return GroundSegmenter(GroundConfig.model_validate({"method": method}))


def _frame(methods: Sequence[str], scene: Scene, rounds: int) -> list[Line]:
    segmenters = [_segmenter(method) for method in methods]
    times, first = np.zeros((rounds + 1, len(methods))), []
    for k in range(rounds + 1):
        for i, segmenter in enumerate(segmenters):
            start = perf_counter()
            ground = segmenter.step(scene.scan.points)
            times[k, i] = (perf_counter() - start) * 1e3
            if k == 0:
                error = height_figures(scene.scan, ground, scene.truth, scene.relief)
                first.append((_told(segmenter), error))
    return [
        Line(
            scene.name,
            method,
            n_pg,
            n_l,
            ms_first=float(times[0, i]),
            ms=float(np.median(times[1:, i])),
            smse=error["smse"],
            rmse=error["height_rmse"],
            rmse_unseen=error["height_rmse_unseen"],
            hyper=hyper,
        )
        for i, (method, ((n_pg, n_l, hyper), error)) in enumerate(zip(methods, first, strict=True))
    ]


def _told(segmenter: GroundSegmenter) -> tuple[float | None, float | None, dict[str, float]]:
    """n_PG, n_L and the hyper-parameters, where a segmenter keeps what it `learned`."""
    learned = segmenter.learned
    return *counts(learned.candidates, learned.supports), dict(learned.hyper)


def counts(candidates: Array, supports: Array) -> tuple[float | None, float | None]:
    """Medians of n_PG and n_L (M,) over the segments that have candidates."""
    candidates, supports = np.asarray(candidates, float), np.asarray(supports, float)
    used = candidates > 0
    n_pg = float(np.median(candidates[used])) if used.any() else None
    there = used & (supports > 0) if supports.shape == used.shape else np.zeros(0, bool)
    return n_pg, float(np.median(supports[there])) if there.any() else None


def compare(lines: Sequence[Line], method: str, base: str) -> str:
    """A sentence: whether `method` beats `base` in height, by a paired bootstrap and a sign test.

    Of each frame the logarithm of the ratio of the two errors is taken, so that a rough frame does not
    outweigh the smooth ones; "beats" needs the bootstrap interval of its mean to lie below 0.
    """
    error = {(line.scene, line.method): line.rmse for line in lines}
    pairs = [(error[s, method], error[s, base]) for s, m in error if m == base and (s, method) in error]
    both = np.array([(a, b) for a, b in pairs if a and b], float).reshape(-1, 2)
    if len(both) < 2:
        return f"{method} against {base}: {len(both)} frames with an error of both; too few to tell"
    log_ratio = np.log(both[:, 0] / both[:, 1])
    low, high = bootstrap(log_ratio)
    wins, ties = int((log_ratio < 0).sum()), int((log_ratio == 0).sum())
    p = float(binomtest(wins, len(both) - ties).pvalue) if len(both) > ties else 1.0
    verb = "beats" if high < 0 else "loses to" if low > 0 else "cannot be told from"
    middle, low, high = (100 * np.expm1(v) for v in (log_ratio.mean(), low, high))
    return (
        f"{method} {verb} {base}: its error against the true ground is {middle:+.1f} % of {base}'s "
        f"(95 % interval {low:+.1f} to {high:+.1f} % over {len(both)} frames), smaller on {wins} of them "
        f"(sign test p = {p:.2g})"
    )


def bootstrap(values: F64) -> tuple[float, float]:
    """Interval of the mean of values (n,), over samples of them with replacement; always the same."""
    rng = np.random.default_rng(0)
    means = values[rng.integers(len(values), size=(DRAWS, len(values)))].mean(1)
    low, high = np.quantile(means, [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return float(low), float(high)


def sentences(lines: Sequence[Line]) -> list[str]:
    """One sentence for each method after the first, held against the first."""
    base, *others = dict.fromkeys(line.method for line in lines)
    made = [compare(lines, other, base) for other in others]
    if len(others) == 2:
        made.append(compare(lines, others[1], others[0]))
    return made


def table51_rows(lines: Sequence[Line]) -> Rows:
    """The table, a row for each frame and method."""
    heads = (
        "frame",
        "method",
        "n_PG",
        "n_L",
        "first [ms]",
        "then [ms]",
        "SMSE",
        "RMSE [m]",
        "RMSE unseen [m]",
    )
    made = []
    for line in lines:
        smse = "-" if line.smse is None else f"{line.smse:.2e}"
        hyper = ", ".join(f"{name} {value:.3g}" for name, value in line.hyper.items()) or "-"
        numbers = (say(line.candidates, 1, 0), say(line.supports, 1, 0), say(line.ms_first, 1, 1))
        errors = (smse, say(line.rmse, 1, 4), say(line.rmse_unseen, 1, 4))
        made.append((line.scene, line.method, *numbers, say(line.ms, 1, 1), *errors, hyper))
    return Rows("Table 5.1", (*heads, "learned"), tuple(made))
