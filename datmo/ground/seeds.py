"""The expected ground h0: plane, then a sheet drawn through connected low cells (de-sloped seeds)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, Bool
from datmo.ground import connectivity
from datmo.ground.coarse import Sheet, SheetRules, flat_sheet, settle
from datmo.ground.config import GroundConfig
from datmo.ground.grid import Candidates, PolarGrid

EXTENT, EXTENT_SLOPE = 0.25, 0.6
OBSTACLE_WEIGHT = 0.05
LOW = 0.5
BLOCK = 3


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


def block_lowest(height: F64, present: Bool, block: int) -> Bool:
    """The lowest candidate (M, N) of each block x block cells; of equals the first."""
    M, N = height.shape
    rows, columns = -(-M // block), -(-N // block)
    padded = np.full((rows * block, columns * block), np.inf)
    padded[:M, :N] = np.where(present, height, np.inf)
    blocks = padded.reshape(rows, block, columns, block).swapaxes(1, 2).reshape(rows * columns, -1)
    best = np.zeros_like(blocks, bool)
    best[np.arange(len(blocks)), blocks.argmin(1)] = True
    whole = best.reshape(rows, columns, block, block).swapaxes(1, 2).reshape(padded.shape)
    return np.asarray(whole[:M, :N] & present)


def expect_ground(cells: Candidates, grid: PolarGrid, config: GroundConfig) -> Expected:
    """The expected ground and the seeds.

    A first sheet goes through the lowest candidates of blocks of cells. Low cells that connect to
    the ground about the sensor carry the next; components that come to lie on it join for the last.
    """
    sheet = flat_sheet(config.radius, config.coarse_cell)
    steep = cells.present & (cells.extent > EXTENT + EXTENT_SLOPE * np.diff(grid.edges)) & config.reject
    weight = np.where(steep, OBSTACLE_WEIGHT, 1.0)
    rules = SheetRules(config.coarse_noise, config.coarse_bend, config.coarse_slope, config.asymmetric)
    xy = cells.xyz[..., :2]

    def draw(use: Bool, start: Sheet, first: bool) -> Sheet:
        return (
            settle(start, xy[use], cells.height[use], weight[use], rules, first) if config.coarse else start
        )

    def over(sheet: Sheet) -> F64:
        return np.where(cells.present, cells.height - sheet(xy.reshape(-1, 2)).reshape(grid.shape), 0)

    sheet = draw(block_lowest(cells.height, cells.present, BLOCK), sheet, True)
    usable = cells.present
    if config.connect:
        label = connectivity.components(cells.r, over(sheet), cells.present & (over(sheet) < LOW))
        usable = connectivity.connected(cells.r, label)
        sheet = draw(usable, sheet, False)
        usable = usable | connectivity.readmitted(label, usable, over(sheet), grid.areas)
    sheet = draw(usable, sheet, False)
    e = over(sheet)
    doubtful = steep & (e > 0)
    seed = usable & ~doubtful & (np.abs(e) < config.seed_height) & (cells.r < config.seed_radius)
    return Expected(sheet, e, usable, doubtful, seed)
