"""Lanes joined to what a road builder sees: lanes that go on into each other, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F64
from sim.scene.roads import Road

JOINT = 0.6  # a lane goes on in one that begins within this [m] ...
TURN = np.deg2rad(10.0)  # ... and turns by no more than this there
SEAM = 0.6  # lanes with a strip narrower than this between them lie side by side [m]
BLEND = 15.0  # length over which what is left of a gap between two lanes is made up for [m]
STEP = 1.0  # spacing of the points of a joined line [m]


@dataclass(frozen=True, eq=False)
class Carriageway:
    """Lanes that lie side by side.

    Attributes:
        line: (m, 2) the middle lane's centreline, a point about every `STEP` [m, world].
        left, right: how far the lanes reach to its left and right [m].
    """

    line: F64
    left: float
    right: float


@njit(cache=True, nogil=True)
def project(line: F64, x: float, y: float) -> tuple[float, float, float]:
    """Of the point of a polyline nearest to (x, y): distance, signed offset to its left, place in segments.

    Beyond the line's ends the offset is that from the end's own segment, drawn on.
    """
    best, left, place = np.inf, 0.0, 0.0
    for s in range(len(line) - 1):
        ex, ey = line[s + 1, 0] - line[s, 0], line[s + 1, 1] - line[s, 1]
        px, py = x - line[s, 0], y - line[s, 1]
        square = max(ex * ex + ey * ey, 1e-18)
        t = min(max((px * ex + py * ey) / square, 0.0), 1.0)
        away = (px - t * ex) ** 2 + (py - t * ey) ** 2
        if away < best:
            best, place = away, s + t
            left = (ex * py - ey * px) / np.sqrt(square)
    return np.sqrt(best), left, place


@njit(cache=True, nogil=True)
def _offsets(line: F64, points: F64, out: F64) -> None:
    for k in range(len(points)):
        out[k] = project(line, points[k, 0], points[k, 1])


def offsets(line: F64, points: F64) -> F64:
    """`project` of points (n, 2) on a line (m, 2): distance, offset to the left, place (n, 3)."""
    out = np.empty((len(points), 3))
    _offsets(np.ascontiguousarray(line), np.ascontiguousarray(points), out)
    return out


def carriageways(roads: Sequence[Road]) -> list[Carriageway]:
    """The carriageways that lanes make up. Lanes that only cross, part or meet stay apart."""
    chains = [(resampled(line), width) for line, width in _chained(roads)]
    group = list(range(len(chains)))
    for i in range(len(chains)):
        for j in range(i):
            if group[i] != group[j] and _side_by_side(*chains[i], *chains[j]):
                old, new = group[i], group[j]
                group = [new if g == old else g for g in group]
    return [
        _joined([c for c, g in zip(chains, group, strict=True) if g == name]) for name in sorted(set(group))
    ]


def resampled(line: F64) -> F64:
    """The same polyline with a point about every `STEP` metres."""
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    keep = np.concatenate([[True], np.diff(arc) > 0])
    at = np.linspace(0.0, arc[-1], max(round(arc[-1] / STEP), 1) + 1)
    return np.column_stack([np.interp(at, arc[keep], line[keep, k]) for k in range(2)])


def _chained(roads: Sequence[Road]) -> list[tuple[F64, float]]:
    """Lines and widths of lanes that go on into each other, each in the one that it turns least into."""
    heads = [_heading(road.centerline[:2])[0] for road in roads]
    tails = [_heading(road.centerline[-2:])[0] for road in roads]
    turns = []
    for i, a in enumerate(roads):
        for j, b in enumerate(roads):
            gap = float(np.hypot(*(b.centerline[0] - a.centerline[-1])))
            turn = abs(float(_wrapped(heads[j] - tails[i])))
            if i != j and gap < JOINT and turn < TURN and a.width == b.width:
                turns.append((round(turn, 6), gap, i, j))
    after: dict[int, int] = {}
    for _, _, i, j in sorted(turns):
        if i not in after and j not in after.values():
            after[i] = j
    runs = _runs(len(roads), after)
    return [(_strung([roads[k].centerline for k in run]), roads[run[0]].width) for run in runs]


def _strung(lines: list[F64]) -> F64:
    """Lines one after the other; where one begins beside the end of the last it is drawn over to it."""
    whole = lines[0]
    for line in lines[1:]:
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
        drawn = line + np.clip(1 - arc / BLEND, 0.0, 1.0)[:, None] * (whole[-1] - line[0])
        whole = np.vstack([whole, drawn[1:]])
    return whole


def _runs(count: int, after: dict[int, int]) -> list[list[int]]:
    """Rows in the order in which they follow each other; a ring begins at its lowest row."""
    runs: list[list[int]] = []
    left = set(range(count))
    for first in [*sorted(left - set(after.values())), *range(count)]:
        run: list[int] = []
        k: int | None = first
        while k is not None and k in left:
            left.remove(k)
            run.append(k)
            k = after.get(k)
        if run:
            runs.append(run)
    return runs


def _side_by_side(a: F64, a_width: float, b: F64, b_width: float) -> bool:
    """Whether at least half of the shorter line runs along the other, lane beside lane."""
    if len(a) > len(b):
        a, b = b, a
    room = (a_width + b_width) / 2 + SEAM
    if (a.max(0) + room < b.min(0)).any() or (b.max(0) + room < a.min(0)).any():
        return False
    found = offsets(b, a)
    apart = (a_width + b_width) / 2
    near = (found[:, 0] > apart / 2) & (found[:, 0] < apart + SEAM)
    inside = (found[:, 2] > 0) & (found[:, 2] < len(b) - 1)
    other = _heading(b)[np.clip(found[:, 2].astype(int), 0, len(b) - 2)]
    own = np.append(_heading(a), _heading(a)[-1])
    along = np.abs(_wrapped(2 * (own - other))) < 2 * TURN  # the other way round is along, too
    return bool((near & inside & along).mean() >= 0.5)


def _joined(lanes: list[tuple[F64, float]]) -> Carriageway:
    """The carriageway of lanes side by side, about the one that lies most in the middle."""
    best: Carriageway | None = None
    for line, _ in lanes:
        side = [float(np.median(offsets(line, other)[:, 1])) for other, _ in lanes]
        left = max(s + width / 2 for s, (_, width) in zip(side, lanes, strict=True))
        right = max(width / 2 - s for s, (_, width) in zip(side, lanes, strict=True))
        if best is None or max(left, right) < max(best.left, best.right) - 1e-6:
            best = Carriageway(line, left, right)
    assert best is not None
    return best


def _heading(line: F64) -> F64:
    """Headings (m - 1,) of a polyline's segments [rad]."""
    step = np.diff(line, axis=0)
    return np.arctan2(step[:, 1], step[:, 0])


def _wrapped(angle: F64) -> F64:
    return np.asarray(np.angle(np.exp(1j * angle)))
