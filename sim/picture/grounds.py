"""A small ground to show of each kind of layer and each class of roughness."""

from __future__ import annotations

from typing import Any

import numpy as np

from scenarios import spec
from scenarios.spec.terrain import Roughness
from sim.scene.roads import Road
from sim.scene.roughness import CLASSES
from sim.scene.terrain import Terrain, build_terrain

HALF = 40.0  # of a ground's side [m]
CELL = 0.25
LAYERS: dict[str, tuple[dict[str, Any], ...]] = {
    "crest": ({"kind": "crest", "at": [0, 5], "height": 2.5, "length": 50},),
    "dip": ({"kind": "dip", "at": [0, 5], "depth": 2.5, "length": 50},),
    "hill": ({"kind": "hill", "at": [-18, 12], "height": 4, "radius": 7},),
    "hills": ({"kind": "hills", "density": 25, "height": [0.5, 3], "radius": [4, 9]},),
    "ramp": ({"kind": "ramp", "at": [0, -22], "rise": 2, "length": 14, "plateau": 12, "width": 9},),
    "step": (
        {"kind": "step", "at": [-24, -14], "rise": 0.3, "plateau": 20, "width": 16},
        {"kind": "step", "at": [-24, -10], "rise": 0.3, "plateau": 12, "width": 10},
    ),
    "bank": ({"kind": "bank", "speed": 14, "limit": 0.12, "runoff": 15},),
    "washboard": ({"kind": "washboard", "at": [0, -30], "length": 40, "amplitude": 0.04, "width": 8},),
    "speed-bump": tuple(
        {"kind": "speed_bump", "at": [0, y], "profile": profile, "length": length}
        for y, profile, length in ((-24, "circular", 3.7), (-12, "sinusoidal", 3.7), (0, "flat_top", 8.0))
    ),
    "pothole": ({"kind": "pothole", "at": [1.5, -10], "depth": 0.1, "radius": 0.8},),
    "potholes": ({"kind": "potholes", "density": 900},),
    "ditch": ({"kind": "ditch"}, {"kind": "ditch", "path": [[-35, -30], [-20, -12], [-35, 5]]}),
    "kerb": ({"kind": "kerb"},),
}
"""The layers of each ground that has any."""


def ground_names() -> tuple[str, ...]:
    """Names of all grounds to show: the plane, the layers, the classes of roughness."""
    return ("plane", *LAYERS, *(f"iso-{letter.lower()}" for letter in CLASSES))


def ground_spec(name: str) -> spec.Terrain:
    """What the scenario of a ground would say.

    Raises:
        KeyError: there is no such ground.
    """
    if name.startswith("iso-"):
        letter: Roughness = CLASSES[[f"iso-{c.lower()}" for c in CLASSES].index(name)]  # type: ignore[assignment]
        return spec.Terrain(cell=CELL, roughness=letter, road_roughness="A")
    slopes = {"grade": 0.1, "cross_slope": 0.05} if name == "plane" else {}
    layers = () if name == "plane" else LAYERS[name]
    return spec.Terrain.model_validate(
        {"cell": CELL, "roughness": "B", "road_roughness": "A", "layers": layers, **slopes}
    )


def ground(name: str) -> Terrain:
    """The ground of a name, on 80 m by 80 m with a straight road, a crossing one and a bend."""
    area = -HALF, -HALF, HALF, HALF
    return build_terrain(ground_spec(name), roads(), area, np.random.SeedSequence(1))


def roads() -> list[Road]:
    """A road of two lanes along y, and one that comes from the west and bends north."""
    straight = np.arange(-60.0, 60.5, 0.5)
    a = np.linspace(-np.pi / 2, 0.0, 80)
    lanes = [Road(np.column_stack([np.full_like(straight, x), straight]), 4.0) for x in (-2.0, 2.0)]
    west = np.arange(-60.0, 0.5, 0.5)
    for radius in (26.0, 30.0):
        bend = np.column_stack([radius * np.cos(a), radius * np.sin(a)])
        into = np.column_stack([west, np.full_like(west, -radius)])
        out = np.column_stack([np.full_like(west, radius), west + 60.0])
        lanes.append(Road(np.vstack([into, bend[1:], out[1:]]), 4.0))
    return lanes
