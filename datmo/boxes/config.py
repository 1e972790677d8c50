"""Settings of the box fit, the rule filter and the guess of kind; lengths in metres."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from datmo.messages import Kind

Range = tuple[float, float]


class FilterConfig(BaseModel):
    """Thresholds of Table 5.2 (method.md section 7), conservative: a part of an object must pass.

    The table names them and gives no values. Upper limits come from the largest vehicles allowed on
    European roads (96/53/EC, Annex I: articulated 16.5 m long, 2.55 m wide, 4.0 m high), checked against
    the largest labels of KITTI's tracking set (sequences 0, 2-5, 7, 9, 11, 17, 20; 23,000 boxes; without
    its tram of 35 m), with room for mirrors, noise and an error of the ground. Lower limits only refuse
    what no road user shows, however much of it is hidden: widths of nothing are legal, for one side seen
    alone is a line.
    No road user floats: the underside of a trailer is 1.2 m high at most. What hides its lower part,
    though, hides it up to the height of an HDL-64 on a car's roof (1.73 m), unless it is itself higher,
    so that is how high a seen part may begin.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    length: Range = Field(
        (0.15, 17.0),
        description="[m]; labels go from 0.20 (a person) to 16.44 (a lorry), 96/53/EC allows 16.5",
    )
    width: Range = Field(
        (0.0, 3.5),
        description="[m]; 96/53/EC allows 2.55, labels reach 2.89 (a lorry with mirrors); a heading off by "
        "2 degrees adds 0.6 to a lorry",
    )
    height: Range = Field(
        (0.5, 4.5),
        description="top above the ground [m]; a child of one year has 0.75 (WHO growth standards), "
        "96/53/EC allows 4.0, labels reach 4.05",
    )
    volume: Range = Field((0.0, 180.0), description="[m³]; 16.5 x 2.55 x 4.0 is 168 (96/53/EC)")
    area: Range = Field((0.0, 50.0), description="seen from above [m²]; 16.5 x 2.55 is 42 (96/53/EC)")
    ratio: Range = Field(
        (1.0, 15.0),
        description="length over width, for boxes longer than ratio_above [1]; labels of these reach 6.6, "
        "and half of the width may be hidden",
    )
    ratio_above: float = Field(
        9.0,
        description="the ratio is checked from this length on [m], the mean of lorries (see KINDS): a part "
        "of a shorter one may be a line (thesis, 5.2.4)",
    )
    slender_height: float = Field(
        2.5,
        description="a box shorter than slender_length may be this high [m]; labelled persons reach 1.96, "
        "poles stand higher",
    )
    slender_length: float = Field(
        1.0, description="[m]; labelled persons reach 1.09 in a stride, vehicles begin at 1.44 (a bicycle)"
    )
    density: float = Field(
        0.3,
        description="least number of points per m³; an HDL-64E sees the rear of a 16.5 m lorry at 60 m with "
        "14 columns and 11 rings, 0.9 of its volume; half may be lost",
    )
    clearance: float = Field(
        1.8, description="largest height of the lowest point above the ground [m]; foliage and signs float"
    )
    points: int = Field(5, ge=1, description="least number of points; scoring asks for objects with 5")


Size = tuple[float, float]


class SizePrior(BaseModel):
    """How common a kind is, and mean and standard deviation of its sizes [m]."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Kind
    share: float = Field(gt=0, le=1, description="how common, road users together are 1 [1]")
    length: Size = Field(description="[m]")
    width: Size = Field(description="[m]")
    height: Size = Field(description="top above the ground [m]")


# Means between those of the labels of KITTI (car 3.9 x 1.6 x 1.56, van 5.1 x 1.9 x 2.2, truck 10.1 x 2.6 x
# 3.2, pedestrian 0.8 x 0.6 x 1.75, cyclist 1.76 x 0.6 x 1.74) and of nuScenes (car 4.6 x 2.0 x 1.7, truck
# 6.9 x 2.5 x 2.8, bus 10.5 x 2.9 x 3.5, pedestrian 0.7 x 0.7 x 1.8), which disagree by about a std. Shares:
# of the 38,864 training labels of KITTI of these kinds (Geiger et al. 2012).
KINDS = (
    SizePrior(kind=Kind.CAR, share=0.74, length=(4.3, 0.45), width=(1.8, 0.15), height=(1.55, 0.2)),
    SizePrior(kind=Kind.VAN, share=0.075, length=(5.2, 0.5), width=(1.95, 0.15), height=(2.2, 0.25)),
    SizePrior(kind=Kind.TRUCK, share=0.028, length=(9.0, 2.5), width=(2.5, 0.2), height=(3.2, 0.5)),
    SizePrior(kind=Kind.PEDESTRIAN, share=0.115, length=(0.7, 0.2), width=(0.6, 0.15), height=(1.7, 0.2)),
    SizePrior(kind=Kind.BICYCLE, share=0.042, length=(1.75, 0.15), width=(0.6, 0.1), height=(1.75, 0.15)),
    # Poles and trunks, which would else be the corner of something large: no road user, and so of no kind.
    SizePrior(kind=Kind.UNKNOWN, share=0.1, length=(0.3, 0.15), width=(0.2, 0.1), height=(4.0, 0.8)),
)


class CompleteConfig(BaseModel):
    """How a seen box becomes a whole one."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kinds: tuple[SizePrior, ...] = Field(KINDS, description="the best names the box; none: as seen")
    grazing: float = Field(0.12, ge=0, lt=1, description="sine below which rays only graze a side [1]")
    cut: float = Field(2.0, ge=0, description="log odds against a side in view being cut by an occluder")
    unknown: float = Field(-10.0, le=0, description="log likelihood below which no kind suits")
    edge: float = Field(0.25, gt=0, description="how far rounded ends fall short of a box, std [m]")
    place: float = Field(0.05, gt=0, description="std of a side's place [m]")


Criterion = Literal["closeness", "area", "squared_error", "weighted", "hull", "volume", "axis-aligned"]


class BoxConfig(BaseModel):
    """How clusters become boxes (method.md section 6)."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    criterion: Criterion = Field(
        "closeness",
        description="of the rectangle search (Zhang 2017); 'hull' takes the rectangle of least area, "
        "'volume' the heading of the box of least volume in space, 'axis-aligned' the axes of the world",
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
    complete: CompleteConfig = CompleteConfig()
    filter: FilterConfig = FilterConfig()
