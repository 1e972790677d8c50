"""The lidar and where it is mounted."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

from pydantic import Field, field_validator

from scenarios.spec.base import Model
from scenarios.spec.returns import Noise, Weather

Outline = tuple[tuple[float, float], ...]


class Sensor(Model):
    """A lidar on the ego's roof."""

    unit: str = Field("hdl64e-s3-20171102", description="a unit by name, or the path of a table (*.csv)")
    range: float = Field(80.0, gt=1, le=240, description="[m]")
    height: float = Field(1.73, gt=0.2, le=5, description="above the ground [m]")
    forward: float = Field(0.0, ge=-10, le=10, description="ahead of the ego's centre [m]")
    left: float = Field(0.0, ge=-3, le=3, description="to the left of the ego's centre [m]")
    roll_deg: float = Field(0.0, ge=-30, le=30, description="right side down positive [deg]")
    pitch_deg: float = Field(0.0, ge=-30, le=30, description="nose down positive [deg]")
    yaw_deg: float = Field(0.0, ge=-180, le=180, description="turned to the left positive [deg]")
    body_mask: bool | Literal["kitti"] | Outline = Field(
        True,
        description="the ego's own body blinds the sensor below an outline: true or 'kitti' for that of "
        "KITTI's car, or points [azimuth, elevation] from -180 to 180 [deg, sensor]; false for none",
    )
    encoder: bool = Field(True, description="uneven azimuth steps, at the encoder's positions")
    range_bias: float = Field(0.0, ge=0, le=0.5, description="standard deviation of the lasers' biases [m]")
    deskew: Literal["none", "ego"] = Field("ego", description="take ego motion out of the points")
    noise: Noise = Noise()
    weather: Weather = Weather()

    @field_validator("body_mask")
    @classmethod
    def _all_round(cls, outline: bool | str | Outline) -> bool | str | Outline:
        if isinstance(outline, tuple):
            azimuth = [a for a, _ in outline]
            if len(outline) < 2 or azimuth[0] != -180 or azimuth[-1] != 180:
                raise ValueError("the outline must go from azimuth -180 to 180; add its ends")
            if any(b <= a for a, b in pairwise(azimuth)):
                raise ValueError(f"azimuths {azimuth} must increase; put the points in order")
        return outline
