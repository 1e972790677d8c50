"""Poses: where the ego and every actor are during one sweep. What traffic hands to the sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, I64, U8
from datmo.errors import SimulationError

BLOCK = 32
"""Columns between two poses; within a block, matrices are interpolated linearly."""


def edges(columns: int, period: float) -> F64:
    """Times (B + 1,) of the block edges relative to the stamp [s], from -period to 0.

    Args:
        columns: columns of a sweep. period: duration of a sweep [s].
    """
    index = np.minimum(np.arange(0, columns + BLOCK, BLOCK), columns)
    return np.asarray(period * (index / columns - 1))


@dataclass(frozen=True, eq=False)
class Poses:
    """The motion of one sweep: ego and k actors at the B + 1 edges of its blocks of columns.

    Attributes:
        time: (B + 1,) relative to the stamp [s], see `edges`.
        T_world_ego: (B + 1, 4, 4) the ego's actor frame.
        T_world_actor: (k, B + 1, 4, 4); origin on the ground under the middle of the box.
        id: (k,). kind: (k,) `Kind`. asset: k keys of the meshes shown in this sweep.
        velocity: (k, 2) at the stamp [m/s, world].

    Raises:
        SimulationError: a shape does not fit the others, or a pose is not finite.
    """

    time: F64
    T_world_ego: F64
    T_world_actor: F64
    id: I64
    kind: U8
    asset: tuple[str, ...]
    velocity: F64

    def __post_init__(self) -> None:
        k, e = len(self.id), len(self.time)
        shapes = {
            "time": (e,),
            "T_world_ego": (e, 4, 4),
            "T_world_actor": (k, e, 4, 4),
            "kind": (k,),
            "velocity": (k, 2),
        }
        for name, shape in shapes.items():
            value = getattr(self, name)
            if value.shape != shape:
                raise SimulationError(f"Poses.{name} has shape {value.shape}; {shape} fits the other fields")
            if not np.isfinite(value).all():
                raise SimulationError(f"Poses.{name} is not finite; every pose of a sweep must be known")
        if len(self.asset) != k:
            raise SimulationError(f"Poses.asset names {len(self.asset)} meshes; give one for each of {k}")

    def __len__(self) -> int:
        return len(self.id)
