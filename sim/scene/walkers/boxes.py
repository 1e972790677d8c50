"""Boxes that people walk around: vehicles, walls, poles; seen from above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, Bool
from scenarios import spec
from sim.scene.scenery.kinds import sort
from sim.scene.scenery.parking import Parked
from sim.scene.scenery.place import size_of
from sim.scene.vehicles import State, body


@dataclass(frozen=True, eq=False)
class Boxes:
    """b rectangles.

    Attributes:
        center: (b, 2) [m, world]. half: (b, 2) half length and width [m]. yaw: (b,) [rad].
        velocity: (b, 2) [m/s, world].
    """

    center: F64
    half: F64
    yaw: F64
    velocity: F64

    def __len__(self) -> int:
        return len(self.yaw)

    def only(self, rows: Bool) -> Boxes:
        """Some of them."""
        return Boxes(self.center[rows], self.half[rows], self.yaw[rows], self.velocity[rows])

    def speed(self) -> F64:
        """(b,) [m/s]."""
        return np.asarray(np.hypot(self.velocity[:, 0], self.velocity[:, 1]))

    def local(self, vectors: F64, turn: float = 1.0) -> F64:
        """Vectors (..., b, 2) of the world in each box's own axes; back with turn = -1."""
        c, s = np.cos(self.yaw), turn * np.sin(self.yaw)
        x, y = vectors[..., 0], vectors[..., 1]
        return np.stack([c * x + s * y, c * y - s * x], -1)

    def gap(self, points: F64) -> F64:
        """From the nearest point of each box to each of `points` (n, 2): (n, b, 2) [m, world].

        Of a point inside, a hundredth of a millimetre along the nearest way out.
        """
        inside = self.local(points[:, None] - self.center)
        away = inside - np.clip(inside, -self.half, self.half)
        out = np.abs(inside) - self.half
        axis = out[..., 0] > out[..., 1]
        exit_ = np.stack([axis, ~axis], -1) * np.where(inside < 0, -1e-5, 1e-5)
        within = np.asarray((out < 0).all(-1))
        return self.local(np.where(within[..., None], exit_, away), -1.0)


def join(parts: Sequence[Boxes]) -> Boxes:
    """All boxes of several."""
    return Boxes(
        np.concatenate([np.zeros((0, 2)), *(p.center for p in parts)]),
        np.concatenate([np.zeros((0, 2)), *(p.half for p in parts)]),
        np.concatenate([np.zeros(0), *(p.yaw for p in parts)]),
        np.concatenate([np.zeros((0, 2)), *(p.velocity for p in parts)]),
    )


def of_states(states: Sequence[State]) -> Boxes:
    """The boxes of actors."""
    return Boxes(
        np.array([s.xy for s in states]).reshape(-1, 2),
        np.array([(s.body.length / 2, s.body.width / 2) for s in states]).reshape(-1, 2),
        np.array([s.yaw for s in states], float),
        np.array([s.velocity for s in states]).reshape(-1, 2),
    )


def of_things(things: Sequence[spec.Thing]) -> Boxes:
    """What of things meets the ground: of a tree, its trunk."""
    foot = [(size_of(t)[0] * sort(t.kind).foot, size_of(t)[1] * sort(t.kind).foot) for t in things]
    return Boxes(
        np.array([t.at for t in things], float).reshape(-1, 2),
        np.array(foot, float).reshape(-1, 2) / 2,
        np.radians(np.array([t.yaw_deg for t in things], float)),
        np.zeros((len(things), 2)),
    )


def of_parked(parked: Sequence[Parked]) -> Boxes:
    """Vehicles that stand beside the road."""
    size = [(body(p.asset).length / 2, body(p.asset).width / 2) for p in parked]
    return Boxes(
        np.array([p.xy for p in parked], float).reshape(-1, 2),
        np.array(size, float).reshape(-1, 2),
        np.array([p.yaw for p in parked], float),
        np.zeros((len(parked), 2)),
    )
