"""The interface behind which the engines stand."""

from __future__ import annotations

from abc import ABC, abstractmethod

from datmo.arrays import F64
from datmo.tracks.models import MotionModel


class Filters(ABC):
    """Prediction and correction of many states at once."""

    jitters: int = 0  # how often a covariance had to be repaired

    @abstractmethod
    def predict(self, model: MotionModel, x: F64, P: F64, dt: float) -> tuple[F64, F64]:
        """States (n, 5) and covariances (n, 5, 5) under `model` after `dt` [s]."""

    @abstractmethod
    def correct(self, x: F64, P: F64, z: F64, R: F64, yaw: F64, yaw_var: F64) -> tuple[F64, F64]:
        """States and covariances after one measurement each.

        Args:
            x: (n, 5). P: (n, 5, 5).
            z: (n, 2) place [m, world]. R: (n, 2, 2) [m²].
            yaw: (n,) [rad], modulo pi; NaN where there is none.
            yaw_var: (n,) [rad²].
        """
