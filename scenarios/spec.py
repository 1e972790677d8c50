"""What a scenario may say: frozen, validated models, SI units in every description.

World frame: z up along gravity, x and y as on a map; the traffic's own map (highway-env's) is
mirrored into it as (x, -y). Lengths in metres, times in seconds, angles in degrees where the
name says so.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from datmo.errors import nearest
from scenarios.expect import UNITS

Roughness = Literal["flat", "A", "B", "C", "D", "E", "F", "G", "H"]
Point = tuple[float, float]
Positive = Annotated[float, Field(gt=0)]


class Model(BaseModel):
    """Frozen; an unknown key is an error; numbers are finite."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Terrain(Model):
    """The ground. Grades are about the world origin, along the world axes."""

    grade: float = Field(0.0, ge=-0.5, le=0.5, description="rise along +y, the ego's first heading [m/m]")
    cross_slope: float = Field(0.0, ge=-0.3, le=0.3, description="rise along +x [m/m]")
    roughness: Roughness = Field("flat", description="ISO 8608 class of the field")
    road_roughness: Roughness = Field("flat", description="ISO 8608 class of the road")
    shoulder: float = Field(3.0, gt=0, le=20, description="width over which road turns into field [m]")
    cell: float = Field(0.3, ge=0.1, le=2.0, description="spacing of the height grid [m]")


class Traffic(Model):
    """Vehicles driven by highway-env."""

    environment: str | None = Field("intersection-v1", description="a highway-env id, or null for none")
    vehicles: int = Field(10, ge=0, le=100, description="vehicles kept within range, the ego not counted")
    warm_up: float = Field(3.0, ge=0, le=60, description="played before the first scan [s]")
    config: dict[str, Any] = Field(default_factory=dict, description="highway-env's own config keys")


class Pedestrian(Model):
    """A walker from `start` to `goal`, there and back while the scenario lasts."""

    behaviour: Literal["crossing", "strolling", "waiting"] = "crossing"
    start: Point = Field(description="[m, world]")
    goal: Point = Field(description="[m, world]")
    speed: float = Field(1.4, gt=0, le=7, description="[m/s]")
    begin: float = Field(0.0, ge=0, description="waits at the start until then [s]")


class WayPoint(Model):
    """Where a scripted actor is at a time."""

    t: float = Field(description="[s] since the first scan; may be negative")
    x: float = Field(description="[m, world]")
    y: float = Field(description="[m, world]")


class Actor(Model):
    """A scripted actor: parked at one way-point, or driven smoothly through several."""

    name: str
    kind: Literal["car", "truck", "pedestrian"]
    path: tuple[WayPoint, ...] = Field(min_length=1)
    yaw_deg: float | None = Field(None, description="heading where the path has one point [deg, world]")
    variant: int = Field(0, ge=0, description="which mesh of its kind")

    @model_validator(mode="after")
    def _in_order(self) -> Actor:
        times = [p.t for p in self.path]
        if any(b <= a for a, b in pairwise(times)):
            raise ValueError(f"times {times} of the path must increase; put the way-points in order")
        return self


class Thing(Model):
    """Static scenery that stands on the terrain."""

    kind: Literal["pole", "wall"]
    at: Point = Field(description="[m, world]")
    size: tuple[Positive, Positive, Positive] = Field(description="length, width, height [m]")
    yaw_deg: float = 0.0


class Noise(Model):
    """What the ideal sensor does not have."""

    range_std: float = Field(0.01, ge=0, le=1, description="standard deviation of range [m]")
    drop_out: float = Field(0.01, ge=0, le=1, description="isolated drop-outs, share of returns")
    grazing: bool = Field(True, description="lose returns by range, incidence and material")


class Sensor(Model):
    """A lidar on the ego's roof."""

    unit: str = Field("hdl64e-s3-20171102", description="a calibrated unit by name")
    range: float = Field(80.0, gt=1, le=120, description="[m]")
    height: float = Field(1.73, gt=0.2, le=5, description="above the ground [m]")
    forward: float = Field(0.0, ge=-3, le=3, description="ahead of the ego's centre [m]")
    pitch_deg: float = Field(0.0, ge=-30, le=30, description="nose down positive [deg]")
    body_mask: bool = Field(True, description="the ego's own body blinds the sensor")
    deskew: Literal["none", "ego"] = Field("ego", description="take ego motion out of the points")
    noise: Noise = Noise()


class Ego(Model):
    """The vehicle that carries the sensor."""

    control: Literal["autopilot", "agent", "parked"] = "autopilot"
    speed: float = Field(8.0, ge=0, le=40, description="the autopilot's cruise [m/s]")
    start: float | None = Field(
        None,
        ge=0,
        le=10_000,
        description="at the first scan, ahead of its first lane's end [m]; null: anywhere",
    )


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
