"""The ground of a scenario."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from scenarios.spec.base import Model

Roughness = Literal["flat", "A", "B", "C", "D", "E", "F", "G", "H"]


class Terrain(Model):
    """The ground. Grades are about the world origin, along the world axes."""

    grade: float = Field(0.0, ge=-0.5, le=0.5, description="rise along +y, the ego's first heading [m/m]")
    cross_slope: float = Field(0.0, ge=-0.3, le=0.3, description="rise along +x [m/m]")
    roughness: Roughness = Field("flat", description="ISO 8608 class of the field")
    road_roughness: Roughness = Field("flat", description="ISO 8608 class of the road")
    shoulder: float = Field(3.0, gt=0, le=20, description="width over which road turns into field [m]")
    cell: float = Field(0.3, ge=0.1, le=2.0, description="spacing of the height grid [m]")
