"""The figures of a run: error of the ground's height, and the time of each stage."""

from __future__ import annotations

import numpy as np

from eval.report.heights import HeightMap
from eval.report.recording import Moment
from eval.report.style import FAINT, GRID, INK, SERIES, figure, png

WIDTH = 9.0
LIMIT = 0.3


def height_error(heights: HeightMap) -> bytes:
    """Map of predicted minus true height over the world: blue too low, red too high, grey unseen."""
    mean, extent = heights.mean()
    spread = np.nanquantile(np.abs(mean), 0.99) if np.isfinite(mean).any() else 0.0
    limit = max(0.05, min(LIMIT, float(np.ceil(spread * 20) / 20)))
    aspect = (extent[3] - extent[2]) / max(extent[1] - extent[0], 1.0)
    made, axes = figure(WIDTH, min(max(WIDTH * 0.85 * aspect, 3.0), 8.5))
    axes.set_facecolor("#c9ccd1")
    image = axes.imshow(
        mean, origin="lower", extent=extent, cmap="RdBu_r", vmin=-limit, vmax=limit, interpolation="nearest"
    )
    axes.set_xlabel("x [m, world]")
    axes.set_ylabel("y [m, world]")
    bar = made.colorbar(image, ax=axes, shrink=0.8, pad=0.02, extend="both")
    bar.set_label("predicted minus true height [m]", color=INK, size=9)
    bar.ax.tick_params(labelsize=8, colors=FAINT, labelcolor=INK)
    bar.outline.set_visible(False)
    return png(made)


def stage_times(moments: list[Moment]) -> bytes:
    """Milliseconds of each stage over time, stacked in the order in which they run."""
    names = max((list(m.milliseconds) for m in moments), key=len)  # the first frame has no traffic
    stamp = np.array([m.stamp for m in moments])
    times = np.array([[m.milliseconds.get(name, 0.0) for m in moments] for name in names])
    made, axes = figure(WIDTH, 3.2)
    base = np.zeros(len(stamp))
    width = 0.9 * float(np.median(np.diff(stamp))) if len(stamp) > 1 else 0.09
    for i, name in enumerate(names):
        label = f"{name.replace('_', ' ')}  {np.median(times[i]):.0f} ms"
        axes.bar(stamp, times[i], width, bottom=base, color=SERIES[i % len(SERIES)], label=label)
        base += times[i]
    top = float(np.quantile(base, 0.98)) * 1.15 if len(base) else 1.0
    axes.set_ylim(0, max(top, 1e-3))  # the first frame may compile kernels; it runs off the top
    axes.margins(x=0.005)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("time of a step [ms]")
    axes.grid(axis="y", color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    if names:
        handles, labels = axes.get_legend_handles_labels()
        axes.legend(
            handles[::-1],
            labels[::-1],
            frameon=False,
            fontsize=8,
            loc="center left",
            bbox_to_anchor=(1.0, 0.5),
            title="medians",
            title_fontsize=8,
        )
    return png(made)
