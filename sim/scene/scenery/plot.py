"""The ground that things take up: where it may be, and that no two share it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from datmo.arrays import F64
from datmo.messages import Kind
from scenarios import spec
from sim.scene.scenery.edges import Edges
from sim.scene.scenery.kinds import sort
from sim.scene.scenery.place import size_of
from sim.scene.terrain import Terrain

CROWN = 0.7  # share of a crown that another thing's plot may not touch
OVERHANG = 0.8  # crowns reach no further over a road: lanes leave vehicles some room [m]
CLOSE = 0.05  # nothing is nearer to a road [m]
ALONG = 1.0  # spacing of the points of an outline [m]
SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


def rectangle(xy: F64, yaw: float, length: float, width: float) -> F64:
    """Corners (4, 2) [m, world], counter-clockwise; yaw [rad]."""
    c, s = np.cos(yaw), np.sin(yaw)
    x, y = (SQUARE * np.array([length, width])).T
    return np.column_stack([c * x - s * y, s * x + c * y]) + xy


def foot(thing: spec.Thing) -> F64:
    """Corners (4, 2) of what meets the ground [m, world]: of a tree, its trunk."""
    return _corners(thing, sort(thing.kind).foot)


def room(thing: spec.Thing) -> F64:
    """Corners (4, 2) of what other things keep out of [m, world]: of a tree, most of its crown."""
    return _corners(thing, max(sort(thing.kind).foot, CROWN))


def needed(kind: str, size: tuple[float, float, float]) -> float:
    """How far beyond a road's edge the middle of a thing must be for its crown [m]; 0 without one."""
    return max(max(size[:2]) / 2 - OVERHANG, 0.0) if sort(kind).foot < 1 else 0.0


def outline(corners: F64) -> F64:
    """Points (n, 2) about `ALONG` apart on the sides of a polygon (p, 2), and its middle [m]."""
    points = [corners.mean(0)[None]]
    for a, b in zip(corners, np.roll(corners, -1, 0), strict=True):
        n = max(int(np.ceil(np.hypot(*(b - a)) / ALONG)), 1)
        points.append(a + (np.arange(n) / n)[:, None] * (b - a))
    return np.concatenate(points)


def _corners(thing: spec.Thing, share: float) -> F64:
    length, width, _ = size_of(thing)
    return rectangle(np.array(thing.at), np.radians(thing.yaw_deg), share * length, share * width)


def overlap(a: F64, b: F64) -> bool:
    """Whether two convex polygons (p, 2) and (q, 2) share ground: no side parts them."""
    for polygon in (a, b):
        side = np.roll(polygon, -1, 0) - polygon
        across = np.column_stack([-side[:, 1], side[:, 0]])
        reach_a = across[:, :1] * a[:, 0] + across[:, 1:] * a[:, 1]
        reach_b = across[:, :1] * b[:, 0] + across[:, 1:] * b[:, 1]
        if ((reach_a.max(1) <= reach_b.min(1)) | (reach_b.max(1) <= reach_a.min(1))).any():
            return False
    return True


class Plots:
    """The plots taken so far.

    Args:
        edges: of the roads, that nothing stands on. terrain: its field is where things may stand.
        taken: polygons (p, 2) [m, world] that are no longer free.
    """

    def __init__(self, edges: Edges, terrain: Terrain, taken: Sequence[F64] = ()) -> None:
        self._edges, self._terrain = edges, terrain
        self._taken: list[F64] = []
        self._middle = np.empty((64, 2))
        self._radius = np.empty(64)
        for polygon in taken:
            self._add(polygon)

    def take(self, thing: spec.Thing, clear: float = 0.0) -> bool:
        """Take the thing's plot if it is free field, `clear` beyond the roads [m]; tell whether it was."""
        points = outline(foot(thing))
        x0, y0, x1, y1 = self._terrain.area
        inside = (points >= [x0, y0]).all() and (points <= [x1, y1]).all()
        if not inside or (self._terrain.kind_at(points) != Kind.FIELD).any():
            return False
        clear, crown = max(clear, CLOSE), needed(thing.kind, size_of(thing))
        off = self._edges.beyond(points, max(clear, crown))
        if off.min() < clear or off[0] < crown:
            return False
        polygon = room(thing)
        if self._crowded(polygon):
            return False
        self._add(polygon)
        return True

    def _crowded(self, polygon: F64) -> bool:
        n, middle = len(self._taken), polygon.mean(0)
        reach = float(np.hypot(*(polygon - middle).T).max())
        apart = np.hypot(*(self._middle[:n] - middle).T)
        near = np.flatnonzero(apart < self._radius[:n] + reach)
        return any(overlap(polygon, self._taken[i]) for i in near)

    def _add(self, polygon: F64) -> None:
        n, middle = len(self._taken), polygon.mean(0)
        if n == len(self._radius):
            self._middle = np.concatenate([self._middle, np.empty_like(self._middle)])
            self._radius = np.concatenate([self._radius, np.empty_like(self._radius)])
        self._middle[n], self._radius[n] = middle, np.hypot(*(polygon - middle).T).max()
        self._taken.append(polygon)
