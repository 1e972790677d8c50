"""The figure of a sweep: one small panel a score, the first key along x, one line for the rest."""

from __future__ import annotations

import itertools

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from eval.report.style import DPI, GRID, INK, SERIES, plain, png
from eval.report.sweep_table import SHOWN, Sweep
from scenarios.expect import UNITS

COLUMNS = 4


def sweep_figure(made: Sweep) -> bytes:
    """PNG of the scores; dots are single seeds, lines their means."""
    rows = -(-len(SHOWN) // COLUMNS)
    figure = Figure(figsize=(11, 2.5 * rows + 0.7), dpi=DPI, layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    panels = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for axes, metric in zip(panels, SHOWN, strict=False):
        _panel(axes, made, metric)
    for axes in panels[len(SHOWN) :]:
        axes.set_visible(False)
    if len(made.keys) > 1:
        handles, labels = panels[0].get_legend_handles_labels()
        title = ", ".join(made.keys[1:])
        style = {"ncols": 8, "frameon": False, "fontsize": 8, "title_fontsize": 8}
        figure.legend(handles, labels, loc="outside upper center", title=title, **style)
    return png(figure)


def _panel(axes: Axes, made: Sweep, metric: str) -> None:
    plain(axes)
    values = list(dict.fromkeys(point[0] for point in made.points))
    rest = list(dict.fromkeys(point[1:] for point in made.points))
    index = {point: row for row, point in enumerate(made.points)}
    for line, colour in zip(rest, itertools.cycle(SERIES), strict=False):
        rows = [index[(value, *line)] for value in values]
        means = [made.mean(row, metric) for row in rows]
        heights = np.array([np.nan if m is None else m for m in means])
        axes.plot(
            range(len(values)),
            heights,
            "o-",
            color=colour,
            markersize=4,
            linewidth=1.4,
            label=", ".join(line),
        )
        if len(made.seeds) > 1:
            _dots(axes, made, rows, metric, colour)
    axes.set_xticks(range(len(values)), values)
    axes.set_xlim(-0.3, len(values) - 0.7)
    unit = UNITS[metric]
    if unit == "count":
        axes.set_ylim(0, max(1.0, 1.05 * axes.get_ylim()[1]))
    axes.set_title(
        metric + ("" if unit in ("1", "count") else f" [{unit}]"), fontsize=9, color=INK, loc="left"
    )
    axes.set_xlabel(made.keys[0], fontsize=8)
    axes.grid(axis="y", color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    if all(made.mean(row, metric) is None for row in range(len(made.points))):
        axes.set_ylim(0, 1)
        axes.text(0.5, 0.5, "nothing to measure", transform=axes.transAxes, ha="center", fontsize=8)


def _dots(axes: Axes, made: Sweep, rows: list[int], metric: str, colour: str) -> None:
    for x, row in enumerate(rows):
        found = [s[metric] for s in made.scores[row]]
        dots = [v for v in found if v is not None]
        axes.plot([x] * len(dots), dots, ".", color=colour, alpha=0.35, markersize=4)
