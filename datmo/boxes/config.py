"""Settings of the box fit, the rule filter and the guess of kind; lengths in metres."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from datmo.messages import Kind

Range = tuple[float, float]


class FilterConfig(BaseModel):
    """Thresholds of Table 5.2 (method.md section 7), conservative: a part of an object must pass.

    Upper limits come from the largest vehicles allowed on European roads (Directive 96/53/EC:
    articulated 16.5 m long, 2.55 m wide, 4.0 m high) with room for mirrors, noise and an error of
    the ground. Lower limits only refuse what no road user shows, however much of it is hidden:
    widths of nothing are legal, for one side seen alone is a line.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    length: Range = Field((0.15, 17.0), description="[m]")
    width: Range = Field((0.0, 3.5), description="[m]")
    height: Range = Field((0.5, 4.5), description="top above the ground [m]; a child of one year has 0.75")
    volume: Range = Field((0.0, 180.0), description="[m³]; 16.5 x 2.55 x 4.0 and a little")
    area: Range = Field((0.0, 50.0), description="seen from above [m²]; 16.5 x 2.55 and a little")
    ratio: Range = Field((1.0, 15.0), description="length over width, for boxes longer than ratio_above [1]")
    ratio_above: float = Field(9.0, description="the ratio is checked from this length on [m]")
    slender_height: float = Field(
        2.5, description="a box shorter than slender_length may be this high [m]; persons are, poles are not"
    )
    slender_length: float = Field(1.0, description="[m]")
    density: float = Field(0.3, description="least number of points per m³; a lorry at 60 m has 0.5")
    points: int = Field(5, ge=1, description="least number of points; scoring asks for objects with 5")


class KindRule(BaseModel):
    """A kind and the sizes, as seen, that suggest it."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Kind
    length: Range = Field(description="[m]")
    width: Range = Field(description="[m]")
    height: Range = Field(description="[m]")


KINDS = (
    KindRule(kind=Kind.PEDESTRIAN, length=(0.2, 1.2), width=(0.0, 1.0), height=(0.9, 2.1)),
    KindRule(kind=Kind.CAR, length=(1.4, 5.6), width=(0.0, 2.4), height=(0.9, 2.1)),
    KindRule(kind=Kind.VAN, length=(1.6, 7.0), width=(0.0, 2.6), height=(2.1, 2.7)),
    KindRule(kind=Kind.TRUCK, length=(2.0, 17.0), width=(0.0, 3.5), height=(2.4, 4.5)),
)


class BoxConfig(BaseModel):
    """How clusters become boxes (method.md section 6)."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    criterion: Literal["closeness", "area", "squared_error", "weighted", "hull"] = Field(
        "closeness", description="of the rectangle search (Zhang 2017); 'hull' is the rectangle of least area"
    )
    weights: tuple[float, float, float] = Field(
        (0.2, 0.5, 0.3), description="of area, closeness and squared error in 'weighted' [1]"
    )
    step: float = Field(1.0, gt=0, le=45, description="angle between two rectangles of the search [deg]")
    nearest: float = Field(
        0.05, gt=0, description="points nearer to an edge count as this near [m]; about three sigma of noise"
    )
    outline_points: int = Field(64, ge=3, description="most points of an outline")
    outline_step: float = Field(0.2, gt=0, description="least azimuth between two outline points [deg]")
    side_tolerance: float = Field(
        0.15, gt=0, description="a point this near to an edge lies on that side [m]"
    )
    half_points: float = Field(20.0, gt=0, description="number of points at which the score is one half")
    kinds: tuple[KindRule, ...] = Field(KINDS, description="the first that fits names the box")
    filter: FilterConfig = FilterConfig()
