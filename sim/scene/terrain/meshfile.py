"""Meshes of the ground: whatever trimesh loads, seen from straight above."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numba import njit

from datmo.arrays import F64, I64
from datmo.errors import ScenarioError
from scenarios import spec
from sim.scene.terrain.grid import Area

MESHES = (".obj", ".ply", ".stl", ".off", ".glb")
SLACK = 1e-9
"""A place counts as over a face up to this far beyond its edges, as a share of the face."""


@njit(cache=True, nogil=True)
def _drape(vertices: F64, faces: I64, x: F64, y: F64, out: F64) -> None:
    """Raise `out` (ny, nx) to the faces over (x[i], y[j]); x and y never fall."""
    for f in range(len(faces)):
        ax, ay, az = vertices[faces[f, 0]]
        bx, by, bz = vertices[faces[f, 1]]
        cx, cy, cz = vertices[faces[f, 2]]
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area == 0.0:  # upright: seen from above it is a line
            continue
        room = SLACK * (abs(bx - ax) + abs(cx - ax) + abs(by - ay) + abs(cy - ay))
        i0 = np.searchsorted(x, min(ax, bx, cx) - room)
        i1 = np.searchsorted(x, max(ax, bx, cx) + room, side="right")
        j0 = np.searchsorted(y, min(ay, by, cy) - room)
        j1 = np.searchsorted(y, max(ay, by, cy) + room, side="right")
        for j in range(j0, j1):
            for i in range(i0, i1):
                u = ((x[i] - ax) * (cy - ay) - (cx - ax) * (y[j] - ay)) / area
                v = ((bx - ax) * (y[j] - ay) - (x[i] - ax) * (by - ay)) / area
                if u >= -SLACK and v >= -SLACK and u + v <= 1 + SLACK:
                    out[j, i] = max(out[j, i], az + u * (bz - az) + v * (cz - az))


@dataclass(frozen=True, eq=False)
class MeshGround:
    """The topmost surface of a mesh.

    Args:
        vertices: (v, 3) [m, world]. faces: (f, 3) rows of them. path: for messages.
    """

    vertices: F64
    faces: I64
    path: str

    @property
    def area(self) -> Area:
        """x_min, y_min, x_max, y_max of its faces [m, world]."""
        used = self.vertices[np.unique(self.faces)]
        low, high = used[:, :2].min(0), used[:, :2].max(0)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def heights(self, x: F64, y: F64) -> F64:
        """Heights (ny, nx) [m] of the topmost faces at x (1, nx) and y (ny, 1) within the area [m, world].

        Raises:
            ScenarioError: there is no face somewhere.
        """
        x, y = x.ravel(), y.ravel()
        height = np.full((len(y), len(x)), -np.inf)
        _drape(self.vertices, self.faces, x, y, height)
        bare = np.isneginf(height)
        if bare.any():
            j, i = np.argwhere(bare)[0]
            raise ScenarioError(
                f"terrain mesh {self.path}: it has holes: no face over {bare.sum()} of {bare.size} places, "
                f"the first at ({x[i]:.2f}, {y[j]:.2f}) m; close them, or give a height map"
            )
        return height


def read_mesh(file: spec.TerrainFile, path: Path) -> MeshGround:
    """The ground of a mesh file, scaled, turned upright and shifted into the world.

    Raises:
        ScenarioError: it cannot be read, has no faces, or vertices that are not finite.
    """
    try:
        mesh: Any = trimesh.load(path, force="mesh", process=False)
        vertices, faces = np.array(mesh.vertices, float), np.array(mesh.faces, np.int64)
    except Exception as error:  # trimesh raises many kinds on a broken file
        raise ScenarioError(
            f"terrain mesh {path}: it cannot be read ({error}); give a mesh with faces"
        ) from None
    if not len(faces):
        raise ScenarioError(
            f"terrain mesh {path}: it has {len(vertices)} vertices and no faces; triangulate it"
        )
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise ScenarioError(
            f"terrain mesh {path}: a face names vertex {faces.max()} of {len(vertices)}; mend it"
        )
    wrong = ~np.isfinite(vertices).all(1)
    if wrong.any():
        raise ScenarioError(
            f"terrain mesh {path}: {wrong.sum()} of {len(vertices)} vertices are not finite, "
            f"the first is number {np.argmax(wrong)}; mend or drop them"
        )
    if file.up == "y":
        vertices = vertices[:, [0, 2, 1]] * np.array([1.0, -1.0, 1.0])
    vertices = vertices * float(file.height_scale or 1.0) + np.array([*file.shift, file.height_offset])
    return MeshGround(np.ascontiguousarray(vertices), np.ascontiguousarray(faces), str(path))
