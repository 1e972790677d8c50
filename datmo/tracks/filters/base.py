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
        """States (k, n) and covariances (k, n, n) under `model` after `dt` [s]."""

    @abstractmethod
    def correct(self, x: F64, P: F64, z: F64, R: F64, yaw: F64, yaw_var: F64) -> tuple[F64, F64]:
        """States and covariances after one measurement each.

        Args:
            x: (k, n). P: (k, n, n).
            z: (k, 2) place [m, world]. R: (k, 2, 2) [m²].
            yaw: (k,) [rad], modulo pi; NaN where there is none.
            yaw_var: (k,) [rad²].
        """
