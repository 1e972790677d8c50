"""The ground as the simulator asks it: a triangulated height grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from datmo.arrays import F32, F64, I32, U8, Bool
from datmo.messages import Kind
from sim.scene.terrain import far
from sim.scene.terrain.grid import Grid

STEPS = 30  # of Newton's method along a ray; two or three are usual
CLOSE = 1e-9  # [m]


@njit(cache=True, nogil=True)
def _place(
    ny: int, nx: int, x0: float, y0: float, cell: float, x: float, y: float
) -> tuple[int, int, float, float, bool]:
    """Row j and column i of the cell at (x, y), clamped to the grid; where in it; whether it was clamped."""
    p, q = (x - x0) / cell, (y - y0) / cell
    u, v = min(max(p, 0.0), nx - 1.0), min(max(q, 0.0), ny - 1.0)
    i, j = min(int(u), nx - 2), min(int(v), ny - 2)
    return j, i, u - i, v - j, u != p or v != q


@njit(cache=True, nogil=True)
def _plane(height: F64, j: int, i: int, u: float, v: float, cell: float) -> tuple[float, float, float]:
    """Height and slopes along x and y of cell (j, i), at (u, v) of it."""
    z00, z11 = height[j, i], height[j + 1, i + 1]
    if u >= v:  # the triangle below the diagonal from (0, 0) to (1, 1)
        z10 = height[j, i + 1]
        du, dv = z10 - z00, z11 - z10
    else:
        z01 = height[j + 1, i]
        du, dv = z11 - z01, z01 - z00
    return z00 + u * du + v * dv, du / cell, dv / cell


@njit(cache=True, nogil=True)
def _look_up(height: F64, x0: float, y0: float, cell: float, xy: F64, out: F64) -> None:
    """Height and slopes (n, 3) at xy (n, 2); NaN where x or y is."""
    ny, nx = height.shape
    for k in range(len(xy)):
        if np.isnan(xy[k, 0]) or np.isnan(xy[k, 1]):
            out[k, 0], out[k, 1], out[k, 2] = np.nan, np.nan, np.nan
            continue
        j, i, u, v, _ = _place(ny, nx, x0, y0, cell, xy[k, 0], xy[k, 1])
        out[k, 0], out[k, 1], out[k, 2] = _plane(height, j, i, u, v, cell)


@njit(cache=True, nogil=True, inline="always")
def _meet(
    height: F64,
    x0: float,
    y0: float,
    cell: float,
    point: tuple[float, float, float],
    d: tuple[float, float, float],
) -> float:
    """Newton's method on z + t dz - H(x + t dx, y + t dy), exact in the triangle that holds the root.

    A step that stays in its triangle is the last. After some steps it may only hop between
    triangles; halving the step then ends the hopping. NaN where it does not settle.
    """
    (ny, nx), (x, y, z), (dx, dy, dz), t = height.shape, point, d, 0.0
    if np.isnan(x) or np.isnan(y):
        return float(np.nan)
    j, i, u, v, off = _place(ny, nx, x0, y0, cell, x, y)
    for step in range(STEPS):
        ground, gx, gy = _plane(height, j, i, u, v, cell)
        gap = z + t * dz - ground
        rate = dz - gx * dx - gy * dy
        if abs(gap) < CLOSE:
            return t
        if rate == 0.0 or np.isnan(gap):
            break
        whole = step < STEPS // 3
        t -= gap / rate if whole else 0.5 * gap / rate
        j0, i0, below, off0 = j, i, u >= v, off
        j, i, u, v, off = _place(ny, nx, x0, y0, cell, x + t * dx, y + t * dy)
        if whole and j == j0 and i == i0 and (u >= v) == below and not (off or off0):
            return t
    return float(np.nan)


@njit(cache=True, nogil=True)
def _along(height: F64, x0: float, y0: float, cell: float, points: F64, d: F64, out: F64) -> None:
    """Distances along d from points (n, 3) [world] to the ground."""
    along = d[0], d[1], d[2]
    for k in range(len(points)):
        out[k] = _meet(height, x0, y0, cell, (points[k, 0], points[k, 1], points[k, 2]), along)


@njit(cache=True, nogil=True)
def _below(height: F64, x0: float, y0: float, cell: float, points: F64, T: F64, out: F32) -> None:
    """z of the ground along the z axis of a frame, below points (n, 3) of it; T takes it to the world."""
    up = T[0, 2], T[1, 2], T[2, 2]
    for k in range(len(points)):
        u, v, w = points[k, 0], points[k, 1], points[k, 2]
        x = T[0, 0] * u + T[0, 1] * v + T[0, 2] * w + T[0, 3]
        y = T[1, 0] * u + T[1, 1] * v + T[1, 2] * w + T[1, 3]
        z = T[2, 0] * u + T[2, 1] * v + T[2, 2] * w + T[2, 3]
        out[k] = w + _meet(height, x0, y0, cell, (x, y, z), up)


@dataclass(frozen=True, eq=False)
class Terrain:
    """A triangulated height grid: row j, column i lies at (x0 + i cell, y0 + j cell).

    Every cell is split along the diagonal from its lowest (x, y) corner to its highest. Beyond the
    grid the ground goes on level from its rim: queries there are clamped to the rim.

    Args:
        x0, y0: the corner [m, world]. cell: spacing [m].
        height: (ny, nx) float64 holding float32 values, so that the mesh is the grid [m, world].
        kind: (ny - 1, nx - 1) uint8 of datmo.messages.Kind, one a cell.
        roughness, road_roughness: ISO 8608 class of the field, and of road and sidewalk.
        coarse: tiles of `far.FACTOR` cells a side that are two triangles each; None: there are none.
    """

    x0: float
    y0: float
    cell: float
    height: F64
    kind: U8
    roughness: str = "flat"
    road_roughness: str = "flat"
    coarse: Bool | None = None

    def height_at(self, xy: F64) -> F64:
        """Heights (n,) [m, world] of the mesh at xy (n, 2) [m, world]."""
        return self._surface(xy)[:, 0].copy()

    def normal_at(self, xy: F64) -> F64:
        """Upward unit normals (n, 3) [world] of the triangles under xy (n, 2) [m, world]."""
        slope = self._surface(xy)[:, 1:]
        normal = np.column_stack([-slope, np.ones(len(slope))])
        return np.asarray(normal / np.sqrt(np.einsum("ij,ij->i", normal, normal))[:, None])

    def kind_at(self, xy: F64) -> U8:
        """Kind (n,) of the cells under xy (n, 2) [m, world]."""
        xy = np.asarray(xy, float).reshape(-1, 2)
        rows, columns = self.kind.shape
        i = np.clip(np.floor((xy[:, 0] - self.x0) / self.cell), 0, columns - 1).astype(int)
        j = np.clip(np.floor((xy[:, 1] - self.y0) / self.cell), 0, rows - 1).astype(int)
        return np.asarray(self.kind[j, i])

    def roughness_at(self, xy: F64) -> NDArray[np.str_]:
        """ISO 8608 class (n,), "A" to "H" or "flat", that the ground under xy (n, 2) was drawn from.

        Over the shoulder, where road turns into field, it is the field's.
        """
        field = self.kind_at(xy) == Kind.FIELD
        return np.where(field, self.roughness, self.road_roughness)

    def along(self, points: F64, direction: F64) -> F64:
        """Signed distances t (n,) [m] at which points + t direction lies on the ground.

        NaN where the line does not settle on the ground (a line that grazes it).

        Args:
            points: (n, 3) [m, world]. direction: (3,) [world], not level, e.g. the sensor's z axis.
        """
        points = np.ascontiguousarray(points, float).reshape(-1, 3)
        out = np.empty(len(points))
        _along(self.height, self.x0, self.y0, self.cell, points, np.asarray(direction, float), out)
        return out

    def below(self, points: F64, T_world_frame: F64, out: F32) -> None:
        """Fill `out` (n,) with z [m, frame] where the line through each point along the frame's z axis
        meets the ground, NaN where it does not settle on it.

        Args:
            points: (n, 3) [m, frame]. T_world_frame: (4, 4).
        """
        _below(self.height, self.x0, self.y0, self.cell, points, T_world_frame, out)

    @property
    def area(self) -> tuple[float, float, float, float]:
        """x_min, y_min, x_max, y_max of the grid [m, world]."""
        ny, nx = self.height.shape
        return self.x0, self.y0, self.x0 + (nx - 1) * self.cell, self.y0 + (ny - 1) * self.cell

    @property
    def vertices(self) -> F32:
        """(v, 3) [m, world], row by row; made anew at each call."""
        ny, nx = self.height.shape
        used = None if self.coarse is None else far.triangles(self.height.shape, self.coarse)[1]
        grid = Grid(self.x0, self.y0, self.cell, nx, ny)
        return far.vertices(grid.x, grid.y, self.height, used)

    @property
    def triangles(self) -> I32:
        """(t, 3), counter-clockwise from above; 2 c and 2 c + 1 make up a cell, or a coarse tile."""
        return far.triangles(self.height.shape, self.coarse)[0]

    @property
    def mesh_kind(self) -> U8:
        """Kind (t / 2,) of each pair of triangles."""
        return far.kinds(self.kind, self.coarse)

    def _surface(self, xy: F64) -> F64:
        xy = np.ascontiguousarray(xy, float).reshape(-1, 2)
        out = np.empty((len(xy), 3))
        _look_up(self.height, self.x0, self.y0, self.cell, xy, out)
        return out
