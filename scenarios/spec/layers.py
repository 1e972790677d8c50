"""Layers of the ground: each adds its own height to those of the others.

Where a layer has `at` and `heading_deg`, s runs from `at` along the heading and t to its left [m].
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from scenarios.spec.base import Model, Point

Range = tuple[float, float]


class _Placed(Model):
    """A layer with a place and a direction."""

    at: Point = Field(description="[x, y] of its reference point [m, world]")
    heading_deg: float = Field(90.0, description="direction of s, counter-clockwise from +x; 90 is +y [deg]")


class Crest(_Placed):
    """A rounded ridge across the heading: half a wave of cosine squared, level at its foot."""

    kind: Literal["crest"] = "crest"
    height: float = Field(gt=0, le=50, description="of its top, which is at `at` [m]")
    length: float = Field(gt=0, le=2000, description="from foot to foot along the heading [m]")
    width: float | None = Field(
        None, gt=0, le=2000, description="from foot to foot across it; null: endless [m]"
    )


class Dip(_Placed):
    """A crest upside down."""

    kind: Literal["dip"] = "dip"
    depth: float = Field(gt=0, le=50, description="of its bottom, which is at `at` [m]")
    length: float = Field(gt=0, le=2000, description="from rim to rim along the heading [m]")
    width: float | None = Field(
        None, gt=0, le=2000, description="from rim to rim across it; null: endless [m]"
    )


class Hill(Model):
    """A Gaussian bell; a hollow where its height is negative."""

    kind: Literal["hill"] = "hill"
    at: Point = Field(description="[x, y] of its top [m, world]")
    height: float = Field(ge=-50, le=50, description="of its top [m]")
    radius: float = Field(gt=0, le=500, description="standard deviation of the bell [m]")


class Hills(Model):
    """Hills strewn at random over the whole ground, the same ones however large it is."""

    kind: Literal["hills"] = "hills"
    density: float = Field(4.0, gt=0, le=100, description="hills a hectare, on average [1/(10^4 m2)]")
    height: Range = Field((0.5, 2.0), description="lowest and highest top [m]")
    radius: Range = Field((8.0, 20.0), description="least and greatest standard deviation [m]")

    @model_validator(mode="after")
    def _ordered(self) -> Hills:
        _ordered("height", self.height, -50.0, 50.0)
        _ordered("radius", self.radius, 0.5, 500.0)
        return self


class Ramp(_Placed):
    """A plane slope from `at` on, a level top behind it, and the same slope down again."""

    kind: Literal["ramp"] = "ramp"
    rise: float = Field(ge=-20, le=20, description="height of the top [m]")
    length: float = Field(gt=0, le=2000, description="of the slope [m]")
    plateau: float | None = Field(None, ge=0, le=2000, description="length of the top; null: endless [m]")
    width: float | None = Field(
        None, gt=0, le=2000, description="across the heading, t within half of it; null: endless [m]"
    )


class Step(_Placed):
    """A ramp as steep as the grid allows: it rises within one cell behind `at`."""

    kind: Literal["step"] = "step"
    rise: float = Field(ge=-5, le=5, description="height of the top [m]")
    plateau: float | None = Field(None, ge=0, le=2000, description="length of the top; null: endless [m]")
    width: float | None = Field(
        None, gt=0, le=2000, description="across the heading, t within half of it; null: endless [m]"
    )


class Bank(Model):
    """Roads lean into their bends: super-elevation e = v²κ/g - f, for a curvature κ [1/m]."""

    kind: Literal["bank"] = "bank"
    speed: float = Field(15.0, gt=0, le=70, description="design speed v [m/s]")
    side_friction: float = Field(0.1, ge=0, le=0.5, description="f, what the tyres are to hold themselves")
    limit: float = Field(0.08, gt=0, le=0.5, description="greatest e [m/m]")
    runoff: float = Field(30.0, gt=0, le=300, description="length over which e builds up [m]")
    verge: float = Field(6.0, gt=0, le=50, description="over which the lean fades beyond the lanes [m]")


class Washboard(_Placed):
    """Ripples across the heading, fading in and out over one wave at either end."""

    kind: Literal["washboard"] = "washboard"
    amplitude: float = Field(0.02, gt=0, le=0.2, description="half of crest to trough [m]")
    wavelength: float = Field(1.2, gt=0, le=10, description="[m]; at least four cells")
    length: float = Field(gt=0, le=2000, description="from `at` along the heading [m]")
    width: float = Field(4.0, gt=0, le=200, description="across the heading, t within half of it [m]")


class SpeedBump(_Placed):
    """A hump across the road, its middle at `at`."""

    kind: Literal["speed_bump"] = "speed_bump"
    profile: Literal["circular", "sinusoidal", "flat_top"] = Field("circular", description="its section")
    height: float = Field(0.1, gt=0, le=0.3, description="[m]")
    length: float = Field(3.7, gt=0, le=30, description="along the heading [m]; at least four cells")
    ramp: float = Field(1.8, gt=0, le=10, description="of a flat top, each of its two slopes [m]")
    width: float = Field(8.0, gt=0, le=200, description="across the road, t within half of it [m]")

    @model_validator(mode="after")
    def _fits(self) -> SpeedBump:
        if self.profile == "flat_top" and 2 * self.ramp > self.length:
            raise ValueError(
                f"two ramps of {self.ramp} m are longer than the bump's {self.length} m; shorten them"
            )
        return self


class Pothole(Model):
    """A round bowl."""

    kind: Literal["pothole"] = "pothole"
    at: Point = Field(description="[x, y] of its middle [m, world]")
    depth: float = Field(0.08, gt=0, le=1, description="[m]")
    radius: float = Field(0.6, gt=0, le=10, description="of its rim [m]; at least two cells")


class Potholes(Model):
    """Potholes strewn at random, the same ones however large the ground is."""

    kind: Literal["potholes"] = "potholes"
    density: float = Field(200.0, gt=0, le=5000, description="holes a hectare, on average [1/(10^4 m2)]")
    depth: Range = Field((0.025, 0.1), description="least and greatest [m]")
    radius: Range = Field((0.6, 1.0), description="least and greatest, of the rim [m]; at least two cells")
    on: Literal["road", "field", "all"] = Field("road", description="where a hole may have its middle")

    @model_validator(mode="after")
    def _ordered(self) -> Potholes:
        _ordered("depth", self.depth, 0.001, 1.0)
        _ordered("radius", self.radius, 0.05, 10.0)
        return self


class Ditch(Model):
    """A trench of trapezoid section, along the roads or along a path; it ends where a road is."""

    kind: Literal["ditch"] = "ditch"
    path: tuple[Point, ...] | None = Field(
        None, min_length=2, description="[x, y] of its bends; null: beside all roads [m, world]"
    )
    offset: float = Field(
        2.0, ge=0, le=50, description="from a road's edge to the ditch's, without a path [m]"
    )
    depth: float = Field(0.6, gt=0, le=5, description="[m]")
    width: float = Field(2.4, gt=0, le=50, description="at the top [m]; at least four cells")
    bottom: float = Field(0.6, ge=0, le=50, description="width of its level floor [m]")

    @model_validator(mode="after")
    def _tapers(self) -> Ditch:
        if self.bottom >= self.width:
            raise ValueError(f"bottom {self.bottom} m is not under the width {self.width} m; narrow it")
        return self


class Kerb(Model):
    """A kerb along the edges of all roads, and a sidewalk behind it; crossings of roads stay clear."""

    kind: Literal["kerb"] = "kerb"
    height: float = Field(0.125, gt=0, le=0.4, description="of the sidewalk above the road [m]")
    sidewalk: float = Field(2.5, gt=0, le=20, description="width of the sidewalk [m]")
    verge: float = Field(1.0, gt=0, le=20, description="over which the field comes up to it [m]")


Layer = Annotated[
    Crest
    | Dip
    | Hill
    | Hills
    | Ramp
    | Step
    | Bank
    | Washboard
    | SpeedBump
    | Pothole
    | Potholes
    | Ditch
    | Kerb,
    Field(discriminator="kind"),
]


def _ordered(name: str, ends: Range, least: float, most: float) -> None:
    if not least <= ends[0] <= ends[1] <= most:
        raise ValueError(f"{name} {list(ends)} must be [low, high] within {least} to {most} m; change it")
