"""A ground from a file, as heights of the grid."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from datmo.arrays import F64
from datmo.errors import ScenarioError, nearest
from scenarios import spec
from sim.scene.terrain.grid import Area, Grid
from sim.scene.terrain.heightmap import MAPS, read_map
from sim.scene.terrain.meshfile import MESHES, read_mesh

HIGHEST = 9000.0
"""More than any ground on Earth, and still fine to half a millimetre in float32 [m]."""


def under(file: spec.TerrainFile, grid: Grid) -> F64:
    """Heights (ny, nx) [m] of the file's ground at the nodes of the grid.

    Raises:
        ScenarioError: the file is missing, of no known kind, broken, or smaller than the grid
            where `outside` is `error`.
    """
    path, ending = Path(file.path), Path(file.path).suffix.lower()
    if ending not in (*MAPS, *MESHES):
        raise ScenarioError(
            f"terrain.file.path {file.path!r} ends in {ending!r}; it must be a height map or a mesh; "
            f"{nearest(ending, (*MAPS, *MESHES))}"
        )
    if not path.is_file():
        raise ScenarioError(
            f"terrain.file.path {file.path!r} is no file; give one that is, from the scenario's own folder "
            "or in full"
        )
    found = read_map(file, path) if ending in MAPS else read_mesh(file, path)
    _check_extent(file, found.area, grid.area)
    x0, y0, x1, y1 = found.area
    height = found.heights(np.clip(grid.x, x0, x1), np.clip(grid.y, y0, y1))
    if np.abs(height).max() > HIGHEST:
        raise ScenarioError(
            f"terrain.file {file.path!r}: heights from {height.min():.4g} to {height.max():.4g} m; "
            f"they must be within {HIGHEST:.0f} m of 0; set height_scale and height_offset"
        )
    return height


def _check_extent(file: spec.TerrainFile, has: Area, needs: Area) -> None:
    """A drive that leaves the file by more than a rounding is an error, unless the scenario clamps it."""
    beyond = max(has[0] - needs[0], has[1] - needs[1], needs[2] - has[2], needs[3] - has[3])
    if file.outside == "error" and beyond > 1e-6:
        theirs, ours = (f"x {a[0]:.1f} to {a[2]:.1f} m, y {a[1]:.1f} to {a[3]:.1f} m" for a in (has, needs))
        raise ScenarioError(
            f"terrain.file {file.path!r} covers {theirs}; the drive and the sensor's range need {ours}; "
            "move it (corner or shift), shorten the drive, or set outside: clamp"
        )
