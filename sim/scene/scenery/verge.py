"""The edges of carriageways: lines along them, at any distance beyond."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from scenarios.spec.scenery import Side
from sim.scene.carriageways import carriageways
from sim.scene.roads import Road


@dataclass(frozen=True, eq=False)
class Verge:
    """One side of a carriageway.

    Attributes:
        line: (m, 2) the paved edge [m, world], in the direction of the traffic that keeps to the right of it.
        arc: (m,) length along it [m].
        outward: (m, 2) unit, away from the road.
    """

    line: F64
    arc: F64
    outward: F64

    @property
    def length(self) -> float:
        """Of the line [m]."""
        return float(self.arc[-1])

    def at(self, arc: F64, beyond: F64) -> F64:
        """Points (n, 2) [m, world] at lengths (n,) and distances (n,) beyond the edge [m]."""
        return self._at(self.line, arc) + beyond[:, None] * self._at(self.outward, arc)

    def yaw(self, arc: float) -> float:
        """Direction of the traffic [rad, world]; the road lies to the left."""
        out = self._at(self.outward, np.array([arc]))[0]
        return float(np.arctan2(out[0], -out[1]))

    def _at(self, values: F64, arc: F64) -> F64:
        return np.column_stack([np.interp(arc, self.arc, values[:, k]) for k in range(2)])


def verges(roads: Sequence[Road], side: Side) -> Iterator[Verge]:
    """The sides of all carriageways, in a fixed order."""
    for way in carriageways(roads):
        if side in ("right", "both"):
            yield _verge(way.line, way.right)
        if side in ("left", "both"):
            yield _verge(way.line[::-1], way.left)


def _verge(line: F64, right: float) -> Verge:
    """The edge `right` metres to the right of a line (m, 2)."""
    way = np.gradient(line, axis=0)
    way /= np.maximum(np.hypot(*way.T), 1e-9)[:, None]
    outward = np.column_stack([way[:, 1], -way[:, 0]])
    edge = line + right * outward
    step = np.hypot(*np.diff(edge, axis=0).T)
    return Verge(edge, np.concatenate([[0.0], np.cumsum(step)]), outward)
