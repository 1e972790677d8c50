"""Figures of one scene and method, by the metrics that every run is scored with."""

from __future__ import annotations

import numpy as np

from datmo.messages import Boxes, Clusters, Frame, Ground, Relief, Scan, Tracks, Truth
from eval.metrics.ground import label_counts, label_detail, label_scores
from eval.metrics.height import height_scores, heights, probabilistic

BANDS = tuple((low, low + 10) for low in range(0, 50, 10))
"""Bands of range in which the coverage is told [m]."""
BLIND = 3.0
"""Unseen ground nearer than this does not count, as in a run [m]."""
COVERAGE = {seen: tuple(f"coverage95_{seen}_{a}-{b}" for a, b in BANDS) for seen in ("seen", "unseen")}
LABELS = ("f1", "precision", "recall", "leak", "leak_above_0.1m", "obstacle_precision")
HEIGHTS = ("height_rmse", "height_rmse_unseen", "smse", "nlpd", "coverage95", "coverage95_unseen")
TIMES = ("ms", "ms_first", "ratio")
NAMES = (*LABELS, *HEIGHTS, *COVERAGE["seen"], *COVERAGE["unseen"], *TIMES)
"""Every figure of a row. ms: median time of a scan in a sequence; ms_first: of the first one;
ratio: median of ms over that of Patchwork++ in the same round."""

Figures = dict[str, float | None]


def frame_of(scan: Scan, ground: Ground) -> Frame:
    """A frame whose ground alone is known."""
    none = Clusters(np.full(len(scan), -1))
    return Frame(scan, ground, none, Boxes.empty(), Tracks.empty(scan.stamp))


def label_figures(scan: Scan, ground: Ground, truth: Truth) -> Figures:
    """The figures of labels."""
    counts = label_counts(frame_of(scan, ground), truth)
    scores = {k.removeprefix("ground."): v for k, v in label_scores(counts).items()}
    scores["leak_above_0.1m"] = label_detail(counts)["leak_above_0.1m"]
    return {name: scores[name] for name in LABELS}


def height_figures(scan: Scan, ground: Ground, truth: Truth, relief: Relief) -> Figures:
    """The figures of heights, coverage by band of range and seen or not."""
    frame, r = frame_of(scan, ground), np.hypot(relief.xy[:, 0], relief.xy[:, 1])
    places = heights(frame, truth, relief, BLIND)
    scores = {k.removeprefix("ground."): v for k, v in height_scores(places).items()}
    scores["coverage95_unseen"] = probabilistic(places.pick(~places.seen))["coverage95"]
    figures: Figures = {name: scores[name] for name in HEIGHTS}
    for i, (low, high) in enumerate(BANDS):
        rows = (r >= low) & (r < high)
        part = Relief(relief.xy[rows], relief.height[rows], relief.exposed[rows], relief.kind[rows])
        band = heights(frame, truth, part, BLIND)
        figures[COVERAGE["seen"][i]] = probabilistic(band.pick(band.seen))["coverage95"]
        figures[COVERAGE["unseen"][i]] = probabilistic(band.pick(~band.seen))["coverage95"]
    return figures


def figures(scan: Scan, ground: Ground, truth: Truth, relief: Relief, gives_heights: bool) -> Figures:
    """All figures but the times, in the order of `NAMES`; those of heights None where there are none."""
    made = dict.fromkeys(NAMES) | label_figures(scan, ground, truth)
    return made | height_figures(scan, ground, truth, relief) if gives_heights else made
