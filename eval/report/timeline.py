"""The timeline of a run: how much of each object is seen, and above it the track it carries."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from datmo.arrays import Array
from datmo.messages import Kind, Visibility
from eval.report.recording import Moment
from eval.report.style import FAINT, INK, figure, png
from sim.picture.palette import track_colour

WIDTH, ROW = 9.0, 0.34
BANDS = {
    Visibility.VISIBLE: ("visible", "#8fbf9f"),
    Visibility.PARTIAL: ("partial", "#e3d48a"),
    Visibility.HEAVY: ("heavy", "#e0a070"),
    Visibility.HIDDEN: ("hidden", "#4a4f58"),
    Visibility.OUT_OF_RANGE: ("out of range", "#eceef1"),
}


def timeline(moments: list[Moment], rate: float) -> bytes:
    """One row an object: the lower band its visibility, the upper the matched track in its colour.

    Objects that were never in range are left out. A number stands where a new track id begins; a
    gap in the upper band is a time without a track.
    """
    objects = _objects(moments)
    made, axes = figure(WIDTH, 0.9 + ROW * max(len(objects), 1))
    names = []
    for row, (identity, kind) in enumerate(objects):
        names.append(f"{Kind(kind).name.lower()} {identity}")
        seen, track, stamp = _history(moments, identity)
        for value, begin, end in _runs(seen):
            if value >= 0:
                span = (stamp[begin] - 0.5 / rate, (end - begin) / rate)
                axes.broken_barh([span], (row + 0.45, 0.36), color=BANDS[Visibility(value)][1], linewidth=0)
        _draw_tracks(axes, row, track, stamp, rate)
    axes.set_yticks(np.arange(len(names)) + 0.45, names)
    axes.set_ylim(max(len(names), 1), -0.15)
    axes.set_xlim(moments[0].stamp - 0.5 / rate, moments[-1].stamp + 0.5 / rate)
    axes.set_xlabel("time [s]")
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    patches = [Patch(color=colour, label=label) for label, colour in BANDS.values()]
    made.legend(handles=patches, loc="outside upper left", ncols=5, frameon=False, fontsize=8)
    return png(made)


def _draw_tracks(axes: Axes, row: int, track: Array, stamp: Array, rate: float) -> None:
    last = -1
    for value, begin, end in _runs(track):
        if value < 0:
            continue
        left, length = stamp[begin] - 0.5 / rate, (end - begin) / rate
        colour = np.array(track_colour(value)) / 255 * 0.9
        axes.broken_barh([(left, length)], (row + 0.05, 0.34), facecolor=colour, edgecolor=INK, linewidth=0.5)
        if value != last:
            style = {"fontsize": 6.5, "color": INK, "va": "center", "clip_on": True}
            axes.text(left + 0.04, row + 0.225, str(value), **style)  # type: ignore[arg-type]
        last = value
    axes.axhline(row + 0.93, color=FAINT, linewidth=0.2)


def _objects(moments: list[Moment]) -> list[tuple[int, int]]:
    """Ids and kinds of the objects that were in range at some time, in the order they came."""
    found: dict[int, int] = {}
    for moment in moments:
        for identity, kind, seen in zip(moment.id, moment.kind, moment.visibility, strict=True):
            if seen != Visibility.OUT_OF_RANGE:
                found.setdefault(int(identity), int(kind))
    return sorted(found.items(), key=lambda item: (item[1], item[0]))


def _history(moments: list[Moment], identity: int) -> tuple[Array, Array, Array]:
    """Visibility (m,), matched track (m,), -1 where absent, and stamps (m,) of one object."""
    seen = np.full(len(moments), -1, np.int64)
    track = np.full(len(moments), -1, np.int64)
    for k, moment in enumerate(moments):
        at = np.flatnonzero(moment.id == identity)
        if len(at):
            seen[k], track[k] = moment.visibility[at[0]], moment.track[at[0]]
    return seen, track, np.array([m.stamp for m in moments])


def _runs(values: Array) -> Iterator[tuple[int, int, int]]:
    """Value, begin and end (exclusive) of each stretch of equal values."""
    edges = np.flatnonzero(np.diff(values)) + 1
    for begin, end in zip([0, *edges], [*edges, len(values)], strict=True):
        yield int(values[begin]), int(begin), int(end)
