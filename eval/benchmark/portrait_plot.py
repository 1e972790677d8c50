"""The figure of objects with their boxes: from above and from the side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from datmo.arrays import F64
from datmo.geometry import corners_bev
from datmo.messages import Boxes
from eval.benchmark.portraits import Portrait
from eval.report.style import DPI, FAINT, INK, SERIES, plain, png

COLUMNS, WIDE, HIGH = 4, 2.9, 3.9  # panels a line, and inches of a pair of them
WHOLE, SEEN = SERIES[0], SERIES[1]
CLUSTERS = SERIES[2:]
STYLES: dict[str, dict[str, Any]] = {
    "truth": {"color": INK, "linewidth": 1.0, "linestyle": "--"},
    "box": {"color": WHOLE, "linewidth": 1.6},
    "seen": {"color": SEEN, "linewidth": 1.2},
}


def plot(portraits: Mapping[str, Portrait]) -> bytes:
    """PNG: each object from above and from the side, the sensor's direction as an arrow."""
    lines = max(-(-len(portraits) // COLUMNS), 1)
    made = Figure(
        figsize=(COLUMNS * WIDE, lines * HIGH + 0.4), dpi=DPI, layout="constrained", facecolor="white"
    )
    FigureCanvasAgg(made)
    panels = made.subplots(2 * lines, COLUMNS, squeeze=False, height_ratios=[3, 2] * lines)
    for axes in panels.flat:
        axes.set_axis_off()
    for i, title in enumerate(sorted(portraits)):
        line, column = divmod(i, COLUMNS)
        pair = panels[2 * line][column], panels[2 * line + 1][column]
        _above(pair[0], portraits[title])
        _beside(pair[1], portraits[title])
        ends = [axes.get_xlim() for axes in pair]
        for axes in pair:
            axes.set_xlim(min(low for low, _ in ends), max(high for _, high in ends))
    names = ("truth", "box", "seen part")
    marks = [Axes.plot(panels[0][0], [], [], **style)[0] for style in STYLES.values()]
    made.legend(marks, names, loc="outside lower center", ncols=3, frameon=False, fontsize=8.5)
    return png(made)


def _above(axes: Axes, portrait: Portrait) -> None:
    _points(axes, portrait, portrait.points[:, 1])
    for name, boxes in _outlines(portrait):
        for corners in corners_bev(boxes.center, boxes.size, boxes.yaw):
            closed = np.vstack([corners, corners[:1]])
            axes.plot(closed[:, 0], closed[:, 1], **STYLES[name])
    reach = float(np.hypot(*portrait.truth.size[0, :2])) / 2
    tip, end = 1.15 * reach * portrait.sensor, 1.5 * reach * portrait.sensor
    axes.update_datalim([tuple(end)])  # an arrow that ends outside would not be drawn
    axes.autoscale_view()
    axes.annotate("", tuple(end), tuple(tip), arrowprops={"arrowstyle": "->", "color": FAINT})
    axes.set_title(f"{portrait.title}\n{len(portrait.points)} returns", fontsize=8.5, color=INK)
    axes.tick_params(labelbottom=False)


def _beside(axes: Axes, portrait: Portrait) -> None:
    _points(axes, portrait, portrait.points[:, 2])
    for name, boxes in _outlines(portrait):
        along = corners_bev(boxes.center, boxes.size, boxes.yaw)[..., 0]
        for x, z, h in zip(along, boxes.center[:, 2], boxes.size[:, 2], strict=True):
            low, high, base, top = x.min(), x.max(), z - h / 2, z + h / 2
            axes.plot([low, high, high, low, low], [base, base, top, top, base], **STYLES[name])


def _outlines(portrait: Portrait) -> list[tuple[str, Boxes]]:
    return [("seen", portrait.found.visible()), ("box", portrait.found), ("truth", portrait.truth)]


def _points(axes: Axes, portrait: Portrait, up: F64) -> None:
    """Returns over the length, a colour for each cluster, grey for none."""
    axes.set_axis_on()
    plain(axes)
    axes.set_aspect("equal")
    names = np.unique(portrait.label[portrait.label >= 0]).tolist()
    colour = {-1: FAINT} | {name: CLUSTERS[i % len(CLUSTERS)] for i, name in enumerate(names)}
    for name in (-1, *names):
        rows = portrait.label == name
        axes.plot(portrait.points[rows, 0], up[rows], ".", color=colour[name], markersize=1.6)
