"""One plain style for every figure, without touching matplotlib's global state."""

from __future__ import annotations

import io
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

INK, FAINT, GRID = "#1c1f24", "#7a808a", "#e4e6ea"
SERIES: Sequence[str] = (
    "#2b6cb0",
    "#d9822b",
    "#2f855a",
    "#b83280",
    "#6b46c1",
    "#8a6d3b",
    "#0e7490",
    "#9b2c2c",
)
DPI = 160


def figure(width: float, height: float) -> tuple[Figure, Axes]:
    """An empty figure of `width` x `height` inches with one plain pair of axes."""
    made = Figure(figsize=(width, height), dpi=DPI, layout="constrained", facecolor="white")
    FigureCanvasAgg(made)
    axes = made.add_subplot()
    plain(axes)
    return made, axes


def plain(axes: Axes) -> None:
    """Only the frame that helps: no top, no right, quiet ticks."""
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(FAINT)
    axes.tick_params(colors=FAINT, labelcolor=INK, labelsize=8, length=3)
    axes.xaxis.label.set(color=INK, size=9)
    axes.yaxis.label.set(color=INK, size=9)


def png(made: Figure) -> bytes:
    """The figure as the bytes of a PNG file, the same for the same figure."""
    buffer = io.BytesIO()
    made.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    return buffer.getvalue()
