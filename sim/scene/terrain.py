"""The ground: a height grid on a sloped plane, rough beside the roads and smoother on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I32, U8
from datmo.errors import SimulationError
from datmo.messages import Kind
from scenarios import spec
from sim.scene.roads import Road, beyond_edge
from sim.scene.roughness import rough_field

MOST_VERTICES = 16_000_000
STEPS = 30  # of Newton's method along a ray; two or three are usual
CLOSE = 1e-9  # [m]


@njit(cache=True, nogil=True)
def _plane(height: F64, x0: float, y0: float, cell: float, x: float, y: float) -> tuple[float, float, float]:
    """Height and slopes along x and y of the mesh at (x, y), clamped to it; NaN where x or y is."""
    if np.isnan(x) or np.isnan(y):
        return np.nan, np.nan, np.nan
    ny, nx = height.shape
    u = min(max((x - x0) / cell, 0.0), nx - 1.0)
    v = min(max((y - y0) / cell, 0.0), ny - 1.0)
    i, j = min(int(u), nx - 2), min(int(v), ny - 2)
    u, v = u - i, v - j
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
    """Height and slopes (n, 3) at xy (n, 2)."""
    for k in range(len(xy)):
        out[k, 0], out[k, 1], out[k, 2] = _plane(height, x0, y0, cell, xy[k, 0], xy[k, 1])


@njit(cache=True, nogil=True)
def _along(height: F64, x0: float, y0: float, cell: float, points: F64, d: F64, out: F64) -> None:
    """Newton's method on z + t dz - H(x + t dx, y + t dy), exact in the triangle that holds the root.

    After some steps it may only hop between triangles; halving the step then ends the hopping.
    """
    for k in range(len(points)):
        x, y, z = points[k, 0], points[k, 1], points[k, 2]
        t, out[k] = 0.0, np.nan
        for step in range(STEPS):
            ground, gx, gy = _plane(height, x0, y0, cell, x + t * d[0], y + t * d[1])
            gap = z + t * d[2] - ground
            rate = d[2] - gx * d[0] - gy * d[1]
            if abs(gap) < CLOSE:
                out[k] = t
                break
            if rate == 0.0 or np.isnan(gap):
                break
            t -= gap / rate if step < STEPS // 3 else 0.5 * gap / rate


def build_terrain(
    terrain: spec.Terrain,
    roads: Sequence[Road],
    area: tuple[float, float, float, float],
    seed: np.random.SeedSequence,
) -> Terrain:
    """The ground of a scenario.

    A plane through the world's origin, plus the field's roughness outside the roads and another,
    independent, roughness on them; the one turns into the other over `terrain.shoulder` metres
    beyond the road's edge.

    Args:
        area: x_min, y_min, x_max, y_max [m, world]; the grid covers it.

    Raises:
        SimulationError: the area is empty, not finite, or too large for its cell.
    """
    x0, y0, ny, nx = _grid(area, terrain.cell)
    cell = terrain.cell
    fields = [np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, i)) for i in range(2)]
    beyond = beyond_edge(roads, (ny, nx), (x0, y0), cell, terrain.shoulder)
    share = np.clip(beyond / terrain.shoulder, 0.0, 1.0)
    share = share * share * (3 - 2 * share)  # smooth step
    height = share * rough_field((ny, nx), cell, terrain.roughness, fields[0])
    if roads:
        height += (1 - share) * rough_field((ny, nx), cell, terrain.road_roughness, fields[1])
    height += terrain.grade * (y0 + cell * np.arange(ny))[:, None]
    height += terrain.cross_slope * (x0 + cell * np.arange(nx))[None, :]
    inside = (beyond[1:, 1:] + beyond[:-1, :-1] + beyond[1:, :-1] + beyond[:-1, 1:]) <= 0
    kind = np.where(inside, Kind.ROAD, Kind.FIELD).astype(np.uint8)
    return Terrain(x0, y0, cell, height.astype(np.float32).astype(float), kind)


def _grid(area: tuple[float, float, float, float], cell: float) -> tuple[float, float, int, int]:
    x_min, y_min, x_max, y_max = area
    if not (np.isfinite(area).all() and x_min < x_max and y_min < y_max):
        raise SimulationError(
            f"the terrain's area is {area}; it must be finite with x_min < x_max and y_min < y_max; widen it"
        )
    nx, ny = (max(int(np.ceil(side / cell - 1e-9)), 1) + 1 for side in (x_max - x_min, y_max - y_min))
    if nx * ny > MOST_VERTICES:
        raise SimulationError(
            f"a terrain of {nx} x {ny} heights is over {MOST_VERTICES}; "
            f"raise terrain.cell above {cell} m or shorten the drive"
        )
    return float(x_min), float(y_min), ny, nx


@dataclass(frozen=True, eq=False)
class Terrain:
    """A triangulated height grid: row j, column i lies at (x0 + i cell, y0 + j cell).

    Every cell is split along the diagonal from its lowest (x, y) corner to its highest. Beyond the
    grid the ground goes on level from its rim: queries there are clamped to the rim.

    Args:
        x0, y0: the corner [m, world]. cell: spacing [m].
        height: (ny, nx) float64 holding float32 values, so that the mesh is the grid [m, world].
        kind: (ny - 1, nx - 1) uint8 of datmo.messages.Kind, one a cell.
    """

    x0: float
    y0: float
    cell: float
    height: F64
    kind: U8

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

    @property
    def area(self) -> tuple[float, float, float, float]:
        """x_min, y_min, x_max, y_max of the grid [m, world]."""
        ny, nx = self.height.shape
        return self.x0, self.y0, self.x0 + (nx - 1) * self.cell, self.y0 + (ny - 1) * self.cell

    @property
    def vertices(self) -> F32:
        """(ny nx, 3) [m, world], row by row; made anew at each call."""
        ny, nx = self.height.shape
        vertices = np.empty((ny, nx, 3), np.float32)
        vertices[..., 0] = self.x0 + self.cell * np.arange(nx)
        vertices[..., 1] = (self.y0 + self.cell * np.arange(ny))[:, None]
        vertices[..., 2] = self.height
        return vertices.reshape(-1, 3)

    @property
    def triangles(self) -> I32:
        """(2 (ny - 1) (nx - 1), 3), counter-clockwise from above; 2 c and 2 c + 1 make up cell c."""
        ny, nx = self.height.shape
        corner = (np.arange(ny - 1, dtype=np.int32)[:, None] * nx + np.arange(nx - 1, dtype=np.int32)).ravel()
        below = np.column_stack([corner, corner + 1, corner + nx + 1])
        above = np.column_stack([corner, corner + nx + 1, corner + nx])
        return np.ascontiguousarray(np.stack([below, above], 1).reshape(-1, 3), np.int32)

    def _surface(self, xy: F64) -> F64:
        xy = np.ascontiguousarray(xy, float).reshape(-1, 2)
        out = np.empty((len(xy), 3))
        _look_up(self.height, self.x0, self.y0, self.cell, xy, out)
        return out
