"""Scenery strewn along the roads and over the fields by rule."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from scenarios.spec.base import Model
from scenarios.spec.things import Size, ThingKind

Side = Literal["left", "right", "both"]
Share = Annotated[float, Field(ge=0, le=1)]
Range = tuple[float, float]


class Row(Model):
    """Things one after the other along the roads; walls, fences, rails and hedges make a line."""

    kind: ThingKind
    offset: Range = Field((1.0, 2.0), description="from the paved edge to the thing's near side [m]")
    every: float = Field(12.0, ge=0.5, le=500, description="spacing, or length of a piece of a line [m]")
    jitter: float = Field(0.0, ge=0, le=100, description="greatest shift along the road [m]")
    share: Share = Field(1.0, description="of the places that are taken")
    side: Side = Field("both", description="of the road, seen along its lanes")
    size: Size | None = Field(None, description="as of a thing; of a line's pieces the length is `every` [m]")

    @model_validator(mode="after")
    def _ordered(self) -> Row:
        low, high = self.offset
        if not 0 <= low <= high <= 100:
            raise ValueError(f"offset {[low, high]} must be [low, high] within 0 to 100 m; change it")
        return self


class Strewn(Model):
    """Things at random places of the field."""

    kind: ThingKind
    density: float = Field(20.0, gt=0, le=2000, description="places a hectare, on average [1/(10^4 m2)]")
    clear: float = Field(3.0, ge=0, le=500, description="kept free beyond the roads' edge [m]")
    reach: float | None = Field(None, gt=0, description="none further than this from a road; null: any [m]")
    size: Size | None = Field(None, description="as of a thing [m]")


class Parking(Model):
    """Vehicles that stand beside the road, along or across it."""

    share: Share = Field(0.6, description="of the places that are taken")
    across: bool = Field(False, description="side by side, nose or tail to the road")
    every: float | None = Field(
        None, ge=2.2, le=500, description="of the road for a place [m]; null: 6.5, across 2.8"
    )
    gap: float = Field(0.3, ge=0, le=20, description="from the road's edge to the vehicle [m]")
    side: Side = "both"
    vans: Share = Field(0.12, description="share of vans")
    trucks: Share = Field(0.0, description="share of trucks")

    @model_validator(mode="after")
    def _shared(self) -> Parking:
        if self.vans + self.trucks > 1:
            raise ValueError(f"vans {self.vans} and trucks {self.trucks} are more than all; lower one")
        return self

    @property
    def place(self) -> float:
        """Length of road that a place takes [m]."""
        return self.every or (2.8 if self.across else 6.5)


STREET = {
    "rows": (
        Row(kind="building", offset=(6.0, 9.0), every=19.0, jitter=1.5, share=0.7),
        Row(kind="tree", offset=(5.0, 8.0), every=8.0, jitter=2.0, share=0.6),
        Row(kind="tree", offset=(1.2, 2.6), every=18.0, jitter=2.0, share=0.6),
        Row(kind="lamp", offset=(0.5, 0.5), every=28.0, side="right"),
        Row(kind="sign", offset=(0.5, 0.8), every=45.0, jitter=8.0, side="right"),
        Row(kind="traffic_light", offset=(0.4, 0.4), every=90.0, share=0.5, side="right"),
        Row(kind="hedge", offset=(2.6, 3.2), every=6.0, share=0.55),
        Row(kind="fence", offset=(2.8, 3.2), every=5.0, share=0.35),
        Row(kind="wall", offset=(2.8, 3.2), every=5.0, share=0.3),
        Row(kind="bush", offset=(3.4, 5.5), every=3.0, jitter=1.0, share=0.6),
        Row(kind="bush", offset=(0.6, 2.0), every=6.0, jitter=2.0, share=0.5),
        Row(kind="bin", offset=(0.6, 1.5), every=25.0, jitter=5.0, share=0.5),
        Row(kind="container", offset=(0.6, 1.0), every=80.0, jitter=20.0, share=0.5),
        Row(kind="bollard", offset=(0.3, 0.3), every=9.0, share=0.15),
    ),
    "strewn": (
        Strewn(kind="bush", density=70, clear=6.0, reach=30.0),
        Strewn(kind="tree", density=25, clear=12.0),
        Strewn(kind="conifer", density=8, clear=12.0),
    ),
}
COUNTRY_ROAD = {
    "rows": (
        Row(kind="rail", offset=(0.5, 0.5), every=8.0, share=0.4, side="right"),
        Row(kind="tree", offset=(3.5, 4.5), every=16.0, jitter=2.0, share=0.6),
        Row(kind="pole", offset=(2.0, 2.0), every=50.0, side="left"),
        Row(kind="sign", offset=(1.0, 1.5), every=80.0, jitter=20.0, side="right"),
        Row(kind="grass", offset=(0.6, 2.5), every=3.0, jitter=1.0, share=0.7),
    ),
    "strewn": (
        Strewn(kind="bush", density=35, clear=4.0),
        Strewn(kind="grass", density=60, clear=1.0, reach=30.0),
        Strewn(kind="tree", density=10, clear=8.0),
        Strewn(kind="conifer", density=5, clear=10.0),
    ),
}
FOREST = {
    "rows": (Row(kind="grass", offset=(0.6, 2.0), every=3.0, jitter=1.0, share=0.6),),
    "strewn": (
        Strewn(kind="conifer", density=120, clear=4.0, reach=45.0),
        Strewn(kind="tree", density=75, clear=4.0, reach=45.0),
        Strewn(kind="bush", density=80, clear=2.0, reach=30.0),
    ),
}
PRESETS = {"none": {}, "street": STREET, "country-road": COUNTRY_ROAD, "forest": FOREST}


class Scenery(Model):
    """What stands around without being listed one by one: a preset's rules, and those given here."""

    preset: Literal["none", "street", "country-road", "forest"] = Field("none", description="rules by name")
    rows: tuple[Row, ...] = ()
    strewn: tuple[Strewn, ...] = ()
    parking: tuple[Parking, ...] = Field((), description="rows of parked vehicles; one, or a list")

    @field_validator("parking", mode="before")
    @classmethod
    def _one_or_more(cls, value: object) -> object:
        """One rule stands for a list of one, null for none."""
        if value is None:
            return ()
        if isinstance(value, dict | Parking):
            return (value,)
        return tuple(value) if isinstance(value, list) else value

    @property
    def all_rows(self) -> tuple[Row, ...]:
        """The preset's rows, then the scenario's own."""
        return (*PRESETS[self.preset].get("rows", ()), *self.rows)  # type: ignore[arg-type]

    @property
    def all_strewn(self) -> tuple[Strewn, ...]:
        """The preset's strewn things, then the scenario's own."""
        return (*PRESETS[self.preset].get("strewn", ()), *self.strewn)  # type: ignore[arg-type]
