"""Ground far from the roads as a coarser mesh: tiles of `FACTOR` cells a side become two triangles.

The heights stay on the fine grid and are made linear on each tile's two triangles, rim and all, so the
grid, the coarse mesh and the fine mesh beside it are one and the same surface, to the rounding of float32.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from datmo.arrays import F32, F64, I32, I64, U8, Bool
from sim.scene.roads import Road, beyond_edge
from sim.scene.terrain.grid import Grid

FACTOR = 4


def coarse_tiles(roads: Sequence[Road], grid: Grid, beyond: float | None) -> Bool | None:
    """Which tiles (rows, columns) lie further than `beyond` from the edge of every road [m]; None: none."""
    rows, columns = (grid.ny - 1) // FACTOR, (grid.nx - 1) // FACTOR
    if beyond is None or not roads or not (rows and columns):
        return None
    away = beyond_edge(roads, (rows + 1, columns + 1), (grid.x0, grid.y0), FACTOR * grid.cell, beyond)
    far = away >= beyond
    coarse = far[1:, 1:] & far[:-1, 1:] & far[1:, :-1] & far[:-1, :-1]
    return coarse if coarse.any() else None


def flatten(height: F64, coarse: Bool | None) -> None:
    """Make the heights (ny, nx) linear on the two triangles of each coarse tile, in place."""
    if coarse is None:
        return
    j, i = (FACTOR * np.nonzero(coarse)[k] for k in (0, 1))
    z00, z10 = height[j, i], height[j, i + FACTOR]
    z01, z11 = height[j + FACTOR, i], height[j + FACTOR, i + FACTOR]
    for b in range(FACTOR + 1):
        for a in range(FACTOR + 1):
            u, v = a / FACTOR, b / FACTOR
            below = z00 * (1 - u) + z10 * (u - v) + z11 * v
            above = z00 * (1 - v) + z01 * (v - u) + z11 * u
            height[j + b, i + a] = below if u >= v else above


def corners(shape: tuple[int, int], coarse: Bool | None) -> tuple[I64, I64]:
    """Rows of the grid's nodes at the lowest corners of all fine cells, then of all coarse tiles."""
    ny, nx = shape
    fine = np.ones((ny - 1, nx - 1), bool)
    if coarse is None:
        return _nodes(fine, 1, nx), np.zeros(0, np.int64)
    rows, columns = coarse.shape
    fine[: FACTOR * rows, : FACTOR * columns] = ~np.repeat(np.repeat(coarse, FACTOR, 0), FACTOR, 1)
    return _nodes(fine, 1, nx), _nodes(coarse, FACTOR, nx)


def triangles(shape: tuple[int, int], coarse: Bool | None) -> tuple[I32, Bool | None]:
    """Triangles (t, 3), two a cell or tile, and which nodes (ny nx,) they use; None: all."""
    nx = shape[1]
    pairs = [_pairs(c, side, nx) for c, side in zip(corners(shape, coarse), (1, FACTOR), strict=True)]
    if coarse is None:
        return pairs[0], None
    faces = np.concatenate(pairs)
    used = np.zeros(shape[0] * nx, bool)
    used[faces.ravel()] = True
    return (np.cumsum(used, dtype=np.int32) - np.int32(1))[faces], used


def kinds(kind: U8, coarse: Bool | None) -> U8:
    """Kind of each pair of triangles, of kinds (ny - 1, nx - 1) of the cells."""
    ny, nx = kind.shape[0] + 1, kind.shape[1] + 1
    node = np.concatenate(corners((ny, nx), coarse))
    return np.ascontiguousarray(kind[node // nx, node % nx])


def vertices(x: F64, y: F64, height: F64, used: Bool | None) -> F32:
    """(v, 3) [m, world] of the used nodes, row by row."""
    nodes = np.empty((*height.shape, 3), np.float32)
    nodes[..., 0], nodes[..., 1], nodes[..., 2] = x, y, height
    every = nodes.reshape(-1, 3)
    return every if used is None else every[used]


def _nodes(cells: Bool, side: int, nx: int) -> I64:
    j, i = np.nonzero(cells)
    return np.asarray(side * (j * nx + i), np.int64)


def _pairs(corner: I64, side: int, nx: int) -> I32:
    """The two triangles of squares, counter-clockwise from above, split from lowest to highest corner."""
    right, up = side, side * nx
    below = np.column_stack([corner, corner + right, corner + up + right])
    above = np.column_stack([corner, corner + up + right, corner + up])
    return np.ascontiguousarray(np.stack([below, above], 1).reshape(-1, 3), np.int32)
