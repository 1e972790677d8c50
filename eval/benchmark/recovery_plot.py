"""Recovery curves: the share of events recovered over the seconds hidden, a panel for each motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from eval.benchmark.recovery import BINS, GROUPS, Recovery
from eval.benchmark.recovery_table import ASKED_RATE
from eval.metrics.recovery_scores import bootstrap_share
from eval.report.style import DPI, FAINT, GRID, INK, SERIES, plain, png


def recovery_curves(results: Sequence[Recovery]) -> bytes:
    """PNG of the curves of some trackers with their 95 % intervals, and what was asked."""
    made = Figure(figsize=(13, 3.3), dpi=DPI, layout="constrained", facecolor="white")
    FigureCanvasAgg(made)
    panels = made.subplots(1, len(GROUPS), sharey=True)
    for axes, group in zip(panels, GROUPS, strict=True):
        _panel(axes, group, results)
    panels[0].set_ylabel("recovered")
    handles, labels = panels[0].get_legend_handles_labels()
    made.legend(handles, labels, loc="outside upper center", ncols=len(labels), frameon=False, fontsize=8)
    return png(made)


def _panel(axes: Axes, group: str, results: Sequence[Recovery]) -> None:
    plain(axes)
    x = np.arange(len(BINS))
    for k, result in enumerate(results):
        events = [result.owned(group, seconds) for seconds in BINS]
        hits = [[e.outcome == "recovered" for e, _ in part] for part in events]
        middle = np.array([np.mean(h) if h else np.nan for h in hits])
        ends = [bootstrap_share(h, [s for _, s in part]) for h, part in zip(hits, events, strict=True)]
        low, high = np.array([(np.nan, np.nan) if e is None else e for e in ends]).T
        offset = 0.08 * (k - (len(results) - 1) / 2)
        spread = np.abs(np.stack([middle - low, high - middle]))
        axes.errorbar(x + offset, middle, spread, fmt="o-", ms=4, lw=1.4, color=SERIES[k], label=result.name)
    if group in ASKED_RATE:
        axes.plot(x, ASKED_RATE[group], "_", ms=16, color=FAINT, label="asked")
    axes.set_xticks(x, BINS)
    axes.set_xlim(-0.4, len(BINS) - 0.6)
    axes.set_ylim(0, 1.03)
    axes.grid(axis="y", color=GRID)
    axes.set_title(group, fontsize=9, color=INK)
    axes.set_xlabel("hidden for [s]")
