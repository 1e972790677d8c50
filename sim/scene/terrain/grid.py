"""Where the heights of a terrain lie."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.errors import SimulationError

MOST_VERTICES = 16_000_000
Area = tuple[float, float, float, float]


@dataclass(frozen=True)
class Grid:
    """Row j, column i lies at (x0 + i cell, y0 + j cell) [m, world]."""

    x0: float
    y0: float
    cell: float
    nx: int
    ny: int

    @property
    def shape(self) -> tuple[int, int]:
        """Rows (y) and columns (x)."""
        return self.ny, self.nx

    @property
    def x(self) -> F64:
        """(1, nx) of the columns [m, world]."""
        return np.asarray(self.x0 + self.cell * np.arange(self.nx, dtype=float))[None, :]

    @property
    def y(self) -> F64:
        """(ny, 1) of the rows [m, world]."""
        return np.asarray(self.y0 + self.cell * np.arange(self.ny, dtype=float))[:, None]

    @property
    def area(self) -> Area:
        """x_min, y_min, x_max, y_max [m, world]."""
        return self.x0, self.y0, self.x0 + (self.nx - 1) * self.cell, self.y0 + (self.ny - 1) * self.cell

    def window(self, box: Area) -> tuple[slice, slice]:
        """Rows and columns of the nodes within a box x_min, y_min, x_max, y_max [m, world]."""
        low = [np.ceil((v - o) / self.cell) for v, o in zip(box[:2], (self.x0, self.y0), strict=True)]
        high = [np.floor((v - o) / self.cell) + 1 for v, o in zip(box[2:], (self.x0, self.y0), strict=True)]
        i0, i1 = (int(np.clip(v, 0, self.nx)) for v in (low[0], high[0]))
        j0, j1 = (int(np.clip(v, 0, self.ny)) for v in (low[1], high[1]))
        return slice(j0, max(j0, j1)), slice(i0, max(i0, i1))


def grid_over(area: Area, cell: float) -> Grid:
    """The grid that covers an area from its lowest corner on.

    Raises:
        SimulationError: the area is empty, not finite, or too large for its cell.
    """
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
    return Grid(float(x_min), float(y_min), cell, nx, ny)
