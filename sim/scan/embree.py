"""The only door to Embree: a static triangle mesh that rays are cast against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from datmo.arrays import F32, I32
from datmo.errors import SimulationError

MISS = np.float32(1e37)  # as far as Embree looks if not told


@dataclass(frozen=True, eq=False)
class Casts:
    """What n rays met first.

    Attributes:
        distance: (n,) along the ray [m]; where nothing was met, how far was looked.
        triangle: (n,) row of the mesh's triangles, -1 nothing.
        normal: (n, 3) of the triangle, counter-clockwise, not of unit length, zeros at a miss.
    """

    distance: F32
    triangle: I32
    normal: F32


class Mesh:
    """One static Embree scene in its default, robust, mode; casting is safe from many threads.

    Args:
        vertices: (v, 3) [m]. triangles: (t, 3) rows of `vertices`, counter-clockwise from outside.

    Raises:
        SimulationError: the mesh is empty, not finite, or names vertices that are not there.
    """

    def __init__(self, vertices: F32, triangles: I32) -> None:
        self.vertices = np.ascontiguousarray(vertices, np.float32)
        self.triangles = np.ascontiguousarray(triangles, np.int32)
        if not len(self.triangles) or not np.isfinite(self.vertices).all():
            raise SimulationError(
                f"a mesh of {len(self.triangles)} triangles is empty or not finite; give finite triangles"
            )
        if self.triangles.min() < 0 or self.triangles.max() >= len(self.vertices):
            raise SimulationError(
                f"a triangle names vertex {self.triangles.max()} of {len(self.vertices)}; rows must exist"
            )
        self._scene = EmbreeScene()
        self._geometry = TriangleMesh(self._scene, self.vertices, self.triangles)
        self.cast(np.zeros((1, 3), np.float32), np.array([[0, 0, 1]], np.float32))  # builds the tree now

    def cast(self, origins: F32, directions: F32, reach: F32 | None = None) -> Casts:
        """Nearest hit of each ray.

        Args:
            origins: (n, 3) [m]. directions: (n, 3) unit.
            reach: (n,) how far each ray looks [m], `MISS` if not given; it is written over and
                becomes `Casts.distance`.
        """
        if not len(origins):
            return Casts(np.zeros(0, np.float32), np.zeros(0, np.int32), np.zeros((0, 3), np.float32))
        hit = self._scene.run(origins, directions, dists=reach, output=1)
        return Casts(hit["tfar"], hit["primID"], hit["Ng"])

    def run(self, origins: F32, directions: F32) -> I32:
        """Nothing but Embree's own cast: the row (n,) of the triangle each ray meets, -1 none."""
        return np.asarray(self._scene.run(origins, directions))
