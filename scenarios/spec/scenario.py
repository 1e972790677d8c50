"""One scenario, complete."""

from __future__ import annotations

from pydantic import Field, model_validator

from datmo.errors import nearest
from scenarios.expect import UNITS
from scenarios.spec.actors import Actor
from scenarios.spec.base import Model
from scenarios.spec.pedestrians import Pedestrian
from scenarios.spec.scenery import Scenery
from scenarios.spec.sensor import Sensor
from scenarios.spec.terrain import Terrain
from scenarios.spec.things import Thing
from scenarios.spec.traffic import Ego, Traffic


class Bound(Model):
    """Limits on one metric; both ends are met when equal."""

    min: float | None = None
    max: float | None = None

    @model_validator(mode="after")
    def _some(self) -> Bound:
        if self.min is None and self.max is None:
            raise ValueError("an expectation needs min or max; write e.g. {min: 0.9}")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError(f"min {self.min} is above max {self.max}; swap them")
        return self


class Scenario(Model):
    """One scenario, complete."""

    name: str = Field(pattern=r"^[a-z0-9][a-z0-9-]*$")
    summary: str = ""
    tags: tuple[str, ...] = ()
    extends: str | None = Field(None, description="the scenario this one starts from")
    duration: float = Field(10.0, gt=0, le=600, description="[s]")
    rate: float = Field(10.0, ge=5, le=20, description="sweeps a second [Hz]")
    terrain: Terrain = Terrain()
    traffic: Traffic = Traffic()
    pedestrians: tuple[Pedestrian, ...] = ()
    actors: tuple[Actor, ...] = ()
    things: tuple[Thing, ...] = ()
    scenery: Scenery = Scenery()
    sensor: Sensor = Sensor()
    ego: Ego = Ego()
    expect: dict[str, Bound] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _known_metrics(self) -> Scenario:
        for name in self.expect:
            if name not in UNITS:
                raise ValueError(f"expect.{name} is no metric; {nearest(name, UNITS)}")
        return self

    @property
    def scans(self) -> int:
        """Scans in an episode: one at t = 0 and one a period."""
        return round(self.duration * self.rate) + 1
