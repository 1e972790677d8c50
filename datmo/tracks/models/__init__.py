"""Motion models, by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from datmo.tracks.config import TrackerConfig
from datmo.tracks.models.base import ACCEL, OMEGA, PSI, PX, PY, MotionModel, V, velocity
from datmo.tracks.models.classic import ConstantTurn, ConstantVelocity, RandomMotion
from datmo.tracks.models.curved import ConstantCurvature, ConstantSteering, ConstantTurnAcceleration

__all__ = [
    "ACCEL",
    "MODELS",
    "OMEGA",
    "PSI",
    "PX",
    "PY",
    "ConstantCurvature",
    "ConstantSteering",
    "ConstantTurn",
    "ConstantTurnAcceleration",
    "ConstantVelocity",
    "MotionModel",
    "RandomMotion",
    "V",
    "make_models",
    "state_size",
    "velocity",
]

MODELS: dict[str, Callable[[TrackerConfig], MotionModel]] = {
    "cv": lambda c: ConstantVelocity(c.accel_density, c.heading_density, c.cv_keeps_yaw_rate),
    "ctrv": lambda c: ConstantTurn(c.accel_density, c.yaw_accel_density),
    "rm": lambda c: RandomMotion(c.random_density, c.accel_density, c.heading_density),
    "ctra": lambda c: ConstantTurnAcceleration(c.jerk_density, c.yaw_accel_density),
    "csav": lambda c: ConstantSteering(c.accel_density, c.curvature_density),
    "cca": lambda c: ConstantCurvature(c.jerk_density, c.curvature_density),
}


def make_models(config: TrackerConfig) -> tuple[MotionModel, ...]:
    """The models that the configuration names, in its order."""
    return tuple(MODELS[name](config) for name in config.models)


def state_size(models: Sequence[MotionModel]) -> int:
    """Coordinates of the state: six where a model knows an acceleration, else five."""
    return 6 if any(model.has_acceleration for model in models) else 5
