"""Tables of the ground benchmark: figures by scene, by class and by grade."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from eval.benchmark.ground_ablation import Cost
from eval.benchmark.ground_grid import Row, mean_figure, methods_of
from eval.benchmark.table import Rows, say

FEW = 8
"""So many scenes are shown one by one; more are shown as means by class and by grade."""
COLUMNS = (
    ("f1", "F1 [%]", 100, 2),
    ("leak", "leak [%]", 100, 2),
    ("leak_above_0.1m", "leak > 0.1 m [%]", 100, 2),
    ("obstacle_precision", "obstacle precision [%]", 100, 1),
    ("height_rmse", "RMSE seen [m]", 1, 3),
    ("height_rmse_unseen", "RMSE unseen [m]", 1, 3),
    ("coverage95", "coverage seen [%]", 100, 1),
    ("coverage95_unseen", "coverage unseen [%]", 100, 1),
    ("nlpd", "NLPD", 1, 2),
    ("ms", "time [ms]", 1, 1),
    ("ratio", "ratio", 1, 2),
)
"""Figure, head, factor and digits."""


def tables(rows: Sequence[Row]) -> list[Rows]:
    """One table of few scenes; of many, one by class and one by grade."""
    if len({row.scene for row in rows}) <= FEW:
        return [_grouped("scene", rows, lambda row: row.scene)]
    return [
        _grouped("class", rows, lambda row: row.roughness),
        _grouped("grade", rows, lambda row: f"{row.grade:g} %"),
        _grouped("all", rows, lambda _: "all scenes"),
    ]


def _grouped(title: str, rows: Sequence[Row], key: Callable[[Row], str]) -> Rows:
    made = []
    for group in dict.fromkeys(key(row) for row in rows):
        for method in methods_of(rows):
            part = [row for row in rows if key(row) == group and row.method == method]
            cells = (say(mean_figure(part, n), factor, digits) for n, _, factor, digits in COLUMNS)
            made.append((group, method, *cells))
    return Rows(title, (title, "method", *(head for _, head, _, _ in COLUMNS)), tuple(made))


def ablation_table(costs: Sequence[Cost]) -> Rows:
    """The whole method, then the change without each idea."""
    shown = [c for c in COLUMNS if c[0] in costs[0][1]]
    made = tuple(
        (name, *(say(got[n], factor, digits, sign=i > 0) for n, _, factor, digits in shown))
        for i, (name, got) in enumerate(costs)
    )
    return Rows("ablation", ("method", *(head for _, head, _, _ in shown)), made, left=1)
