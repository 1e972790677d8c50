"""The figure of the ground benchmark: each measure against roughness and against slope."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from eval.benchmark.ground_grid import Row, mean_figure, methods_of
from eval.benchmark.ground_methods import best
from eval.benchmark.ground_peers import PEERS
from eval.report.style import DPI, FAINT, GRID, INK, SERIES, plain, png

MEASURES = (
    ("f1", "F1 [%]", 100.0),
    ("leak", "leak [%]", 100.0),
    ("height_rmse", "height RMSE, seen [m]", 1.0),
    ("coverage95", "coverage, seen [%]", 100.0),
    ("ms", "time [ms]", 1.0),
)
NOMINAL = 95.0
PEER_NAMES = tuple(name for name, _, _ in PEERS)
PEER_STYLES = ("--", ":")


def plot(rows: Sequence[Row]) -> bytes:
    """PNG: a line of panels for each measure; left over the classes, right over the grades."""
    classes = list(dict.fromkeys(row.roughness for row in rows))
    grades = sorted({row.grade for row in rows})
    made = Figure(figsize=(8.4, 10.6), dpi=DPI, layout="constrained", facecolor="white")
    FigureCanvasAgg(made)
    panels = made.subplots(len(MEASURES), 2, sharey="row", squeeze=False)
    for line, (name, head, factor) in zip(panels, MEASURES, strict=True):
        by_class = [[row for row in rows if row.roughness == c] for c in classes]
        by_grade = [[row for row in rows if row.grade == g] for g in grades]
        _curves(line[0], by_class, methods_of(rows), name, factor)
        _curves(line[1], by_grade, methods_of(rows), name, factor)
        line[0].set_ylabel(head)
        line[0].set_xticks(range(len(classes)), classes)
        line[1].set_xticks(range(len(grades)), [f"{g:g}" for g in grades])
    panels[-1][0].set_xlabel("roughness of the field: ISO 8608 class, or rms [m]")
    panels[-1][1].set_xlabel("steepest slope [%]")
    handles, labels = panels[0][0].get_legend_handles_labels()
    made.legend(handles, labels, loc="outside upper center", ncols=len(labels), frameon=False, fontsize=8.5)
    return png(made)


def _curves(
    axes: Axes, groups: Sequence[Sequence[Row]], methods: Sequence[str], name: str, factor: float
) -> None:
    """One curve a method of the groups' means; what has no figure has no mark."""
    plain(axes)
    axes.grid(axis="y", color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    if name == "coverage95":
        axes.axhline(NOMINAL, color=FAINT, linewidth=0.9)
    for i, method in enumerate(methods):
        found = [mean_figure((r for r in group if r.method == method), name) for group in groups]
        x = [k for k, value in enumerate(found) if value is not None]
        y = [factor * value for value in found if value is not None]
        style, colour = "-", SERIES[i % len(SERIES)]
        if method in PEER_NAMES:
            style, colour = PEER_STYLES[PEER_NAMES.index(method)], INK
        wide = 2.2 if method == best() else 1.3
        axes.plot(x, y, style, color=colour, linewidth=wide, marker="o", markersize=3.2, label=method)
    axes.margins(x=0.06)
