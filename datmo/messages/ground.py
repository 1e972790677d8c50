"""Ground: which points are ground, and a surface that answers at any place."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field

import numpy as np

from datmo.arrays import F32, F64, Bool
from datmo.messages.base import Message


class Surface(ABC):
    """The ground as a function of place. Concrete surfaces are messages too (equal by content)."""

    @abstractmethod
    def __call__(self, xy: F64) -> tuple[F64, F64]:
        """Height and its standard deviation, seen or not.

        Args:
            xy: (n, 2) [m, sensor].

        Returns:
            mean (n,) and standard deviation (n,) of the height z [m, sensor]; the deviation is
            of the latent height, without the noise of an observation.
        """


@dataclass(frozen=True, eq=False)
class Plane(Message, Surface):
    """z = a x + b y + c with one standard deviation; what is said where nothing was measured."""

    a: float = 0.0
    b: float = 0.0
    c: float = -1.73
    std: float = 1.0

    def __call__(self, xy: F64) -> tuple[F64, F64]:
        """See `Surface`."""
        xy = np.asarray(xy, float)
        return self.a * xy[:, 0] + self.b * xy[:, 1] + self.c, np.full(len(xy), self.std)


@dataclass(frozen=True, eq=False)
class Ground(Message):
    """The ground of one scan, row-aligned with its points.

    Attributes:
        is_ground: (n,) bool.
        height: (n,) z [m, sensor] where the line through the point along the sensor's z axis
            meets the ground.
        height_std: (n,) [m].
        surface: answers height and deviation at any (x, y) [m, sensor].
    """

    is_ground: Bool
    height: F32
    height_std: F32
    surface: Surface = field(default_factory=Plane)

    def __post_init__(self) -> None:
        self._set("is_ground", (None,), np.bool_)
        n = len(self.is_ground)
        self._set("height", (n,), np.float32)
        self._set("height_std", (n,), np.float32)

    def __len__(self) -> int:
        return len(self.is_ground)
