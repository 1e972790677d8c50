"""Settings of clustering and of merging; lengths in metres."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class ClusterConfig(BaseModel):
    """How elevated points become clusters (method.md section 5).

    The cell follows the spacing of the returns. Along the ring an HDL-64 at 10 Hz fires every
    0.003 rad, so 0.008 rad holds two firings with one lost between them; along the ray the gaps
    are those between the laser rings on a bonnet or a roof, several times wider.

    What hangs (a crown, a bridge, a sign) is parted from what stands below it by a gap of height. Rings
    of an HDL-64 that look upward are 0.006 rad apart, so 0.015 holds two of them and some noise; a
    sparser unit asks for more. No gap parts what begins below the headroom.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    grid: Literal["polar", "plain"] = Field(
        "polar", description="cells that grow with range, or the thesis's plain grid (Alg. 8)"
    )
    cell: float = Field(0.25, gt=0, description="smallest cell, and the cell of the plain grid [m]")
    growth_along: float = Field(0.016, gt=0, description="length of a cell along the ray over its range [1]")
    growth_across: float = Field(0.008, gt=0, description="width of a cell across the ray over its range [1]")
    max_range: float = Field(80.0, gt=0, description="points farther than this belong to no cluster [m]")
    min_height: float = Field(0.3, description="lowest height above the ground that links cells [m]")
    max_height: float = Field(
        3.5, gt=0, description="points higher than this belong to no cluster; without layers [m]"
    )
    layers: bool = Field(True, description="part what hangs from what stands below it; in the polar grid")
    gap: float = Field(0.3, gt=0, description="least gap of height under what hangs [m]")
    gap_growth: float = Field(0.015, ge=0, description="least gap of height over its range [1]")
    headroom: float = Field(
        2.0, description="what begins lower than this above the ground stands on what is below it [m]"
    )


class MergeConfig(BaseModel):
    """When clusters under one predicted box become one (method.md section 8, Alg. 9)."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    enabled: bool = Field(True, description="whether clusters are merged at all")
    share: float = Field(
        0.5, ge=0, le=1, description="overlap over the smaller area that makes a candidate [1]"
    )
    area_factor: float = Field(1.3, gt=0, description="largest merged area over the predicted area [1]")
    tolerance: float = Field(0.4, ge=0, description="how far the merged size may exceed the predicted [m]")
    pad: float = Field(0.1, gt=0, description="least extent of a footprint, so that a line has an area [m]")


class SplitConfig(BaseModel):
    """When a cluster that several predicted boxes share is cut (under-segmentation)."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    enabled: bool = Field(True, description="whether clusters are cut at all")
    tolerance: float = Field(
        0.3, gt=0, description="a point this far outside a predicted box may still be its own [m]"
    )
    points: int = Field(5, ge=1, description="least number of points that make a box's claim")
    apart: float = Field(
        0.7,
        ge=0,
        description="two moving boxes whose velocities differ by less may be parts of one body [m/s]",
    )
    explained: float = Field(
        0.7, gt=0, le=1, description="a claim of which another box holds this share is none [1]"
    )
