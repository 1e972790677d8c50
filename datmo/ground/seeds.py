"""The expected ground h0: plane, then a sheet drawn through connected low cells (de-sloped seeds)."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, Bool
from datmo.ground import connectivity
from datmo.ground.config import GroundConfig
from datmo.ground.grid import Candidates, PolarGrid
from datmo.ground.lattice import Lattice, corners, evaluate, prior
from datmo.ground.sheet import Sheet, coarse_lattice, flat_sheet, settle

EXTENT, EXTENT_SLOPE = 0.25, 0.6
OBSTACLE_WEIGHT = 0.05
LOW = 0.5
BLOCK = 3
RIDGE = 3.0


@dataclass(frozen=True)
class Expected:
    """What the growth starts from.

    Attributes:
        sheet: h0 over the plane. e: (M, N) candidate's height over h0 [m].
        usable: (M, N) candidates that may be ground. doubtful: (M, N) those over h0 in a cell whose
        points reach far up. seed: (M, N) where the growth starts.
    """

    sheet: Sheet
    e: F64
    usable: Bool
    doubtful: Bool
    seed: Bool


@numba.njit(cache=True, nogil=True)
def block_lowest(height: F64, present: Bool, block: int) -> Bool:
    """The lowest candidate (M, N) of each block x block cells; of equals the first."""
    M, N = height.shape
    out, columns = np.zeros((M, N), np.bool_), -(-N // block)
    best, at = np.full(columns, np.inf), np.zeros(columns, np.int64)
    for m in range(M):
        for b in range(N):
            if present[m, b] and height[m, b] < best[b // block]:
                best[b // block], at[b // block] = height[m, b], m * N + b
        if m % block == block - 1 or m == M - 1:
            for k in range(columns):
                if best[k] < np.inf:
                    out[at[k] // N, at[k] % N] = True
            best[:] = np.inf
    return out


class _Low:
    """The candidates of one scan over its plane, and where they stand on the sheet's lattice."""

    def __init__(self, cells: Candidates, plane: F64, grid: PolarGrid, lattice: Lattice) -> None:
        self.height = cells.above(plane)
        self._present, self._shape = cells.present, grid.shape
        azimuth, r = cells.azimuth.ravel(), cells.r.ravel()
        self.places = corners(azimuth, r, lattice.lines, grid.segments, lattice.radii)

    def over(self, sheet: Sheet) -> F64:
        """Height (M, N) of the candidates over a sheet [m], 0 where there is none."""
        return np.where(
            self._present, self.height - evaluate(sheet.f, *self.places).reshape(self._shape), 0.0
        )


class GroundExpectation:
    """Finds the expected ground and the seeds; holds the lattice and its prior, nothing of a frame."""

    def __init__(self, grid: PolarGrid, config: GroundConfig) -> None:
        self._grid, self.config = grid, config
        self._flat = flat_sheet(coarse_lattice(grid.segments, grid.centers))
        c = config
        self._prior = prior(self._flat.lattice, c.coarse_bend, c.coarse_slope, RIDGE, c.coarse_noise)
        self._steep = EXTENT + EXTENT_SLOPE * np.diff(grid.edges)
        self._size = np.hypot(np.diff(grid.edges), grid.centers * 2 * np.pi / grid.segments)

    def __call__(self, cells: Candidates, plane: F64) -> Expected:
        """The expected ground of one scan over its local slope, z = a x + b y + c of `plane` (3,)."""
        config = self.config
        extent = cells.extent - np.hypot(plane[0], plane[1]) * self._size
        steep = cells.present & (extent > self._steep) & config.reject
        low = _Low(cells, plane, self._grid, self._flat.lattice)
        sheet, usable = self._draw(low, cells, steep)
        e = low.over(sheet)
        doubtful = steep & (e > 0)
        seed = usable & ~doubtful & (np.abs(e) < config.seed_height) & (cells.r < config.seed_radius)
        return Expected(sheet, e, usable, doubtful, seed)

    def _draw(self, low: _Low, cells: Candidates, steep: Bool) -> tuple[Sheet, Bool]:
        """The sheet, and the candidates (M, N) that carry it.

        A first sheet goes through the lowest candidates of blocks of cells. Low cells that connect to the
        ground about the sensor carry the next, steep ones left out; components and steep cells that come
        to lie on it join for the last.
        """
        if not self.config.coarse:
            return self._flat, cells.present
        weight, areas = np.where(steep, OBSTACLE_WEIGHT, 1.0), self._grid.areas
        sheet = self._settle(
            low, np.where(block_lowest(low.height, cells.present, BLOCK), weight, 0.0), self._flat, True
        )
        usable = cells.present
        if self.config.connect:
            e = low.over(sheet)
            label = connectivity.components(cells.r, e, low.height, cells.present & (e < LOW) & ~steep)
            usable = connectivity.connected(cells.r, label, areas)
            sheet = self._settle(low, np.where(usable, weight, 0.0), sheet, False)
            e = low.over(sheet)
            usable = usable | connectivity.readmitted(label, usable, e, areas)
            usable |= steep & (np.abs(e) < connectivity.STEP)
        return self._settle(low, np.where(usable, weight, 0.0), sheet, False), usable

    def _settle(self, low: _Low, weight: F64, start: Sheet, first: bool) -> Sheet:
        noise, asymmetric = self.config.coarse_noise, self.config.asymmetric
        y, w = low.height.ravel(), weight.ravel()
        return settle(start, y, w, low.places, self._prior, noise, asymmetric, first)
