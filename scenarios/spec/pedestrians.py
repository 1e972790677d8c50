"""People on foot."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from scenarios.spec.base import Model, Point, Positive

RUNS = 2.2  # who is faster runs [m/s]
WALKER, RUNNER = 1.4, 3.0  # [m/s]


class Trigger(Model):
    """What sets someone going."""

    distance: Positive = Field(description="so near must a vehicle come [m]")
    of: Literal["ego", "vehicle"] = Field("ego", description="the ego only, or any vehicle")


class Pedestrian(Model):
    """One walker, or a group, from `start` to `goal`, there and back while the scenario lasts.

    Those crossing, strolling or in stop-and-go wait at the kerb for a free road; those jaywalking or
    running out step on it as soon as vehicles could stop at all. Who runs out stays at the goal.
    """

    behaviour: Literal["crossing", "strolling", "waiting", "jaywalking", "stop-and-go", "running-out"] = (
        "crossing"
    )
    start: Point = Field(description="[m, world]")
    goal: Point = Field(description="[m, world]")
    speed: float | None = Field(None, gt=0, le=7, description="[m/s]; null: 1.4, and 3 for those who run")
    begin: float = Field(0.0, ge=0, description="waits at the start until then [s]")
    trigger: Trigger | None = Field(None, description="and then until a vehicle comes near")
    running: bool = Field(False, description="faster than 2.2 m/s; who runs out always runs")
    group: int = Field(1, ge=1, le=12, description="people who walk together")
    age: Literal["adult", "child", "any"] = Field("any", description="of the meshes to choose from")

    @model_validator(mode="after")
    def _fast_enough(self) -> Pedestrian:
        if self.runs and self.pace < RUNS:
            raise ValueError(f"speed {self.speed} m/s is walking; people run above {RUNS} m/s; raise it")
        return self

    @property
    def runs(self) -> bool:
        """Whether they run."""
        return self.running or self.behaviour == "running-out"

    @property
    def pace(self) -> float:
        """Desired speed [m/s]."""
        return self.speed if self.speed is not None else RUNNER if self.runs else WALKER
