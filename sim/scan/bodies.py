"""Bodies: the meshes of moving things, each built once and shared, with their bounds for culling."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Protocol

import numpy as np

from datmo.arrays import F32, F64, I32
from sim.scan.embree import Mesh
from sim.scene.assets import asset


class Shape(Protocol):
    """What a body is made of; `sim.scene.assets.Asset` is one. Actor frame."""

    @property
    def vertices(self) -> F32:
        """(v, 3) [m]."""

    @property
    def triangles(self) -> I32:
        """(t, 3)."""

    @property
    def size(self) -> tuple[float, float, float]:
        """Length, width, height of its box [m]."""

    @property
    def reflectivity(self) -> F32:
        """(t,) 0..1 of each triangle."""


@dataclass(frozen=True, eq=False)
class Body:
    """A mesh in the actor frame, ready to be cast at.

    Attributes:
        mesh: its Embree scene.
        low: (3,), high: (3,) bounds of its vertices [m, actor].
        center: (3,), radius: a sphere around them [m, actor].
        reflectivity: (t,) of each triangle.
        size: length, width, height of its box [m].
    """

    mesh: Mesh
    low: F64
    high: F64
    center: F64
    radius: float
    reflectivity: F32
    size: tuple[float, float, float]


def body_of(shape: Shape) -> Body:
    """Build the scene of a shape and measure it."""
    mesh = Mesh(shape.vertices, shape.triangles)
    used = mesh.vertices[np.unique(mesh.triangles)].astype(float)
    low, high = used.min(0), used.max(0)
    center = (low + high) / 2
    radius = float(np.sqrt(((used - center) ** 2).sum(1)).max())
    reflectivity = np.ascontiguousarray(shape.reflectivity, np.float32)
    return Body(mesh, low, high, center, radius, reflectivity, shape.size)


@cache
def body(key: str) -> Body:
    """The body of a catalogue asset ("car/3"), built once a process."""
    return body_of(asset(key))
