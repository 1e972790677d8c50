"""The lidar and where it is mounted."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from scenarios.spec.base import Model
from scenarios.spec.returns import Noise


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
