"""Lanes as lines on the map, and a course: the lanes a vehicle follows, with the crossings on it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from datmo.arrays import F64
from sim.scene.autopilot import STEP

Key = tuple[str, str, int]
"""A lane: from node, to node, number beside others."""

NEAR = 2.2  # lanes with centres nearer than this share ground [m]
STOP_LINE = 6.0  # ahead of a crossing, where walkers may cross [m]
BEYOND = 80.0  # a course goes on in a straight line after its last lane [m]
APART = 1.0  # lanes end to end that lie farther apart are bridged [m]


@dataclass(frozen=True, eq=False)
class Lane:
    """One lane.

    Attributes:
        line: (n, 2) points along its centre, evenly spaced [m, world].
        length: along the centre [m]. width: [m].
        crossing: shares ground with a lane that it neither leads to nor comes from.
        entry, leaving: nothing leads to it; it leads nowhere.
        added: by which its end was carried on beyond that of highway-env's own lane [m].
    """

    key: Key
    line: F64
    length: float
    width: float
    crossing: bool = False
    entry: bool = False
    leaving: bool = False
    added: float = 0.0

    def at(self, arc: F64) -> F64:
        """Points (m, 2) at arc lengths (m,) from its start."""
        s = np.linspace(0.0, self.length, len(self.line))
        return np.stack([np.interp(arc, s, self.line[:, i]) for i in range(2)], -1)

    def direction(self, arc: float) -> F64:
        """Unit vector (2,) along the lane."""
        ends = self.at(np.clip([arc - 0.25, arc + 0.25], 0.0, self.length))
        step = ends[1] - ends[0]
        return np.asarray(step / np.hypot(*step))


def crossings(lines: Mapping[Key, F64]) -> set[Key]:
    """The lanes that share ground with a lane they are not joined to end to end."""
    trees = {key: cKDTree(line) for key, line in lines.items()}
    found = set()
    for a, line in lines.items():
        for b, tree in trees.items():
            joined = a[1] == b[0] or b[1] == a[0]
            if a != b and not joined and np.isfinite(tree.query(line, distance_upper_bound=NEAR)[0]).any():
                found.add(a)
                break
    return found


def bridged(lanes: Sequence[Lane]) -> tuple[list[Lane], list[int]]:
    """Lanes end to end, straight pieces between those that lie apart, and where the lanes are in the list.

    The arms of roundabout-v0 end 5.6 m from its ring.
    """
    pieces, places = [lanes[0]], [0]
    for lane in lanes[1:]:
        gap = np.stack([pieces[-1].line[-1], lane.line[0]])
        length = float(np.hypot(*(gap[1] - gap[0])))
        if length > APART:
            pieces.append(Lane(lane.key, gap, length, lane.width))
        places.append(len(pieces))
        pieces.append(lane)
    return pieces, places


class Course:
    """The way of one vehicle: lanes end to end.

    Args:
        lanes: in order.
        names: a number for each lane that is a crossing.

    Attributes:
        keys: of the lanes. starts: (n + 1,) arc length at which each lane starts, and the end [m].
        points: (m, 2) every `STEP` along it [m, world].
        zones: stop line, end and name of each crossing [m along the course].
    """

    def __init__(self, lanes: Sequence[Lane], names: Mapping[Key, int]) -> None:
        self.keys = [lane.key for lane in lanes]
        pieces, places = bridged(lanes)
        begins = np.concatenate([[0.0], np.cumsum([piece.length for piece in pieces])])
        self.starts = begins[[*places, -1]]
        arcs = np.arange(0.0, begins[-1], STEP)
        owner = np.clip(np.searchsorted(begins, arcs, side="right") - 1, 0, len(pieces) - 1)
        parts = [piece.at(arcs[owner == i] - begins[i]) for i, piece in enumerate(pieces)]
        after = np.arange(STEP, BEYOND, STEP)[:, None] * lanes[-1].direction(lanes[-1].length)
        self.points: F64 = np.concatenate([*parts, parts[-1][-1] + after])
        self.zones: list[tuple[float, float, int]] = []
        for i, lane in enumerate(lanes):
            if not lane.crossing:
                continue
            if i and lanes[i - 1].crossing:
                start, _, name = self.zones.pop()
            else:
                start, name = self.starts[i] - STOP_LINE, names[lane.key]
            self.zones.append((float(start), float(self.starts[i + 1]), name))

    def ahead(self, rear: float, reach: float) -> F64:
        """Points from the rear bumper's arc length on, over `reach` metres; at least two."""
        i = int(np.clip(np.floor(rear / STEP), 0, len(self.points) - 2))
        return self.points[i : max(i + int(reach / STEP), i + 2)]

    def zone(self, rear: float) -> tuple[float, float, int] | None:
        """The next crossing the rear has not left: stop line and end [m from the rear], and name."""
        for start, end, name in self.zones:
            if end > rear:
                return start - rear, end - rear, name
        return None


def onward(lanes: Mapping[Key, Lane], last: Lane) -> list[Lane]:
    """The lanes that go on from one, at most one a road: each is the nearest of its road, and the other way.

    So nobody cuts across lanes to an exit, and who enters a ring of two lanes takes the outer one.
    """
    roads = dict.fromkeys(key[:2] for key in lanes if key[0] == last.key[1])
    beside = [lane for lane in lanes.values() if lane.key[:2] == last.key[:2]]
    found = []
    for road in roads:
        near = min((b for b in lanes.values() if b.key[:2] == road), key=lambda b: _apart(last, b))
        if min(beside, key=lambda a: _apart(a, near)) is last:
            found.append(near)
    return found


def follow(
    lanes: Mapping[Key, Lane], keys: Sequence[Key], least: float, rng: np.random.Generator
) -> list[Lane]:
    """The lanes `keys`, then on by chance, until `least` metres are reached or the road ends."""
    course = [lanes[key] for key in keys]
    while sum(lane.length for lane in course) < least:
        choice = onward(lanes, course[-1])
        if course[-1].leaving or not choice:
            break
        course.append(choice[int(rng.integers(len(choice)))])
    return course


def _apart(a: Lane, b: Lane) -> float:
    """From the end of one lane to the beginning of another [m]."""
    return float(np.hypot(*(b.line[0] - a.line[-1])))
