"""The ground of a scenario."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from scenarios.spec.base import Model, Point
from scenarios.spec.layers import Layer

Roughness = Literal["flat", "A", "B", "C", "D", "E", "F", "G", "H"]
FINEST = 0.1  # the least spacing of the height grid [m]
NEEDS = {
    "crest": (("length", 4), ("width", 4)),
    "dip": (("length", 4), ("width", 4)),
    "hill": (("radius", 2),),
    "hills": (("radius", 2),),
    "ramp": (("length", 1), ("width", 2)),
    "step": (("width", 2),),
    "washboard": (("wavelength", 4), ("width", 2)),
    "speed_bump": (("length", 4), ("ramp", 1), ("width", 2)),
    "pothole": (("radius", 2),),
    "potholes": (("radius", 2),),
    "ditch": (("width", 4),),
    "kerb": (("sidewalk", 2),),
}
"""Which measures of a layer need how many cells at least, so that the grid can show them."""


class TerrainFile(Model):
    """A ground from a file, under everything else: a height map or a mesh, told by the name's end."""

    path: str = Field(
        min_length=1, description=".png, .tif, .npy, .obj, .ply, .stl ...; relative to the scenario's file"
    )
    pixel: float | None = Field(
        None, gt=0, le=100, description="a height map's spacing; null: as a GeoTIFF says [m]"
    )
    height_scale: float | None = Field(
        None, gt=0, description="metres a unit of the file's heights; null: 1, and not for .png"
    )
    height_offset: float = Field(0.0, description="added after scaling [m]")
    corner: Point | None = Field(
        None, description="[x, y] of a map's lowest x and y; null: its middle is the origin [m, world]"
    )
    shift: Point = Field((0.0, 0.0), description="[x, y] added to a mesh's scaled coordinates [m]")
    up: Literal["y", "z"] = Field("z", description="the axis of a mesh that points up")
    outside: Literal["error", "clamp"] = Field(
        "error", description="where the drive leaves the file: an error, or level on from its rim"
    )


class Terrain(Model):
    """The ground. Grades are about the world origin, along the world axes."""

    grade: float = Field(0.0, ge=-0.5, le=0.5, description="rise along +y, the ego's first heading [m/m]")
    cross_slope: float = Field(0.0, ge=-0.3, le=0.3, description="rise along +x [m/m]")
    roughness: Roughness = Field("flat", description="ISO 8608 class of the field")
    road_roughness: Roughness = Field("flat", description="ISO 8608 class of the road")
    shoulder: float = Field(3.0, gt=0, le=20, description="width over which road turns into field [m]")
    cell: float = Field(0.3, ge=FINEST, le=2.0, description="spacing of the height grid [m]")
    coarse_beyond: float | None = Field(
        None,
        ge=0,
        le=500,
        description="so far from the roads the mesh has cells four times as wide; null: no [m]",
    )
    layers: tuple[Layer, ...] = Field((), description="what else shapes the ground; their heights add up")
    file: TerrainFile | None = Field(None, description="a height map or mesh under all else")

    @model_validator(mode="after")
    def _resolved(self) -> Terrain:
        """What is finer than the grid can show would come out as something else."""
        for i, layer in enumerate(self.layers):
            for name, cells in NEEDS.get(layer.kind, ()):
                said = getattr(layer, name)
                size = min(said) if isinstance(said, tuple) else said
                if size is None or size >= cells * self.cell - 1e-9:
                    continue
                finer = f"set cell to {size / cells:.3g}, or " if size >= cells * FINEST else ""
                raise ValueError(
                    f"layers.{i} ({layer.kind}): {name} {size} m is under {cells} cells of {self.cell} m; "
                    f"{finer}make it {cells * self.cell:.3g} m"
                )
        for kind in ("bank", "kerb"):
            if sum(layer.kind == kind for layer in self.layers) > 1:
                raise ValueError(f"layers: {kind} is there twice and holds for all roads; keep one of them")
        return self
