"""Layers: what stands in a cell and what hangs above it, parted by a gap of height.

Heights are cut into bins, so that one integer a cell says which of them hold a point. What begins below
the headroom stands on what is below it, whatever the gap: a car's windows return nothing. What begins
higher hangs free where the gap below it is wide enough.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from datmo.arrays import I32, I64, Array
from datmo.clusters.config import ClusterConfig
from datmo.clusters.grid import PolarGrid

BIN = 0.1  # [m]
BINS = 60  # as many as an integer of 64 bits holds, and some room; the last is open above


@dataclass(frozen=True)
class Layers:
    """The layers of all cells, by cell and from the ground up.

    Attributes:
        first: (cells + 1,) cell c has the layers first[c] .. first[c + 1] - 1.
        cell: (layers,) of each.
        low, high: (layers,) lowest and highest bin of each.
        rest: (layers,) what ends below this bin is apart from the layer: too far below it to hold it up.
            Below every bin for what stands.
    """

    first: I32
    cell: I32
    low: I32
    high: I32
    rest: I32


def find_layers(cell: I32, height: Array, grid: PolarGrid, config: ClusterConfig) -> Layers:
    """The layers of all points not lower than `min_height`.

    Args:
        cell: (n,) of each point, -1 without one.
        height: (n,) of each point above the ground [m].
        grid: of the cells. config: settings; without `layers` a cell has one.
    """
    occupied = _occupancy(cell, height, config.min_height, grid.size)
    gap = np.ceil(np.maximum(config.gap, config.gap_growth * grid.edges[1:]) / BIN)
    headroom = np.ceil((config.headroom - config.min_height) / BIN) if config.layers else BINS
    gaps = np.repeat(np.minimum(gap, BINS).astype(np.int64), grid.columns)
    return Layers(*_split(occupied, gaps, int(min(headroom, BINS))))


def label_points(label: I32, layers: Layers, cell: I32, height: Array, config: ClusterConfig) -> I32:
    """Label (n,) of each point: that of its layer, and of its cell's lowest layer for one below the bins.

    Points without a cell, and low ones under what hangs, have -1.

    Args:
        label: (layers,). The others as in `find_layers`.
    """
    return np.asarray(_label(cell, height, label, layers.first, layers.low, layers.rest, config.min_height))


@njit(cache=True, nogil=True)
def _bin(height: float, bottom: float) -> int:
    return int(min((height - bottom) / BIN, BINS - 1.0)) if height >= bottom else -1


@njit(cache=True, nogil=True)
def _occupancy(cell: I32, height: Array, bottom: float, size: int) -> I64:
    """Bit b of each cell (size,) is set where a point of it lies in bin b."""
    occupied = np.zeros(size, np.int64)
    for i in range(len(cell)):
        if cell[i] >= 0 and height[i] >= bottom:
            occupied[cell[i]] |= np.int64(1) << _bin(height[i], bottom)
    return occupied


@njit(cache=True, nogil=True)
def _split(occupied: I64, gap: I64, headroom: int) -> tuple[I32, I32, I32, I32, I32]:
    """Fields of `Layers`; in cell c at least gap[c] empty bins part what begins at `headroom` or higher."""
    first = np.empty(len(occupied) + 1, np.int32)
    most = np.count_nonzero(occupied) * (BINS // 2)  # one empty bin at least between two
    cell, low = np.empty(most, np.int32), np.empty(most, np.int32)
    high, rest = np.empty(most, np.int32), np.empty(most, np.int32)
    count = 0
    for c in range(len(occupied)):
        first[c] = count
        word, b = occupied[c], 0
        while word >> b:
            if word >> b & 1:
                hold = b - gap[c] if b >= headroom else -1
                if count == first[c] or high[count - 1] < hold:
                    cell[count], low[count], rest[count] = c, b, hold
                    count += 1
                high[count - 1] = b
            b += 1
    first[-1] = count
    return first, cell[:count], low[:count], high[:count], rest[:count]


@njit(cache=True, nogil=True)
def _label(cell: I32, height: Array, label: I32, first: I32, low: I32, rest: I32, bottom: float) -> I32:
    out = np.full(len(cell), -1, np.int32)
    for i in range(len(cell)):
        if cell[i] < 0:
            continue
        k, last = first[cell[i]], first[cell[i] + 1] - 1
        b = _bin(height[i], bottom)
        while k < last and low[k + 1] <= b:
            k += 1
        if k <= last and b >= rest[k]:
            out[i] = label[k]
    return out
