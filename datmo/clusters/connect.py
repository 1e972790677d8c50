"""Connected components of occupied cells and their layers, 8-neighbourhood: two passes with union-find.

Labels follow the lowest cell of each component, then its lowest layer, so they do not depend on the
order of the points.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.ndimage import label as label_image

from datmo.arrays import I32, I64, Bool
from datmo.clusters.grid import PolarGrid
from datmo.clusters.layers import Layers
from datmo.union_find import join


def connect_polar(layers: Layers, grid: PolarGrid) -> I32:
    """Component (layers,) of each layer of a polar grid: those of cells that touch, unless they are apart."""
    own = (layers.first, layers.cell, layers.high, layers.rest)
    return np.asarray(_connect(*own, grid.columns, grid.first))


def connect_plain(occupied: Bool) -> I32:
    """Component (m, n) of each cell of a plain grid, -1 where empty (Alg. 8, corrected)."""
    image, count = label_image(occupied, np.ones((3, 3)))
    component = np.asarray(image, np.int32).ravel() - 1
    found, lowest = np.unique(component, return_index=True)
    rank = np.full(count + 1, -1, np.int32)  # last entry: empty cells, -1
    labels = found[found >= 0]
    rank[labels[np.argsort(lowest[found >= 0])]] = np.arange(count)
    return rank[component].reshape(occupied.shape)


@njit(cache=True, nogil=True)
def _connect(layer: I32, cells: I32, high: I32, rest: I32, columns: I64, first: I64) -> I32:
    parent = np.arange(len(cells)).astype(np.int32)
    ring = 0
    for a in range(len(cells)):
        while cells[a] >= first[ring] + columns[ring]:
            ring += 1
        n, j = columns[ring], cells[a] - first[ring]
        _link(parent, layer, high, rest, a, first[ring] + (j - 1) % n)
        if ring == 0:
            continue
        # Columns of the ring inside whose closed azimuth interval meets [j, j + 1] / n.
        m = columns[ring - 1]
        for k in range(-((-j * m) // n) - 1, ((j + 1) * m) // n + 1):
            _link(parent, layer, high, rest, a, first[ring - 1] + k % m)
    label = np.empty_like(parent)
    count = 0
    for a in range(len(parent)):  # a root is the lowest member of its component: it comes first
        if parent[a] == a:
            label[a] = count
            count += 1
        else:
            label[a] = label[parent[a]]
    return label


@njit(cache=True, nogil=True)
def _link(parent: I32, layer: I32, high: I32, rest: I32, a: int, other: int) -> None:
    """Join layer a and those of the cell `other` that are not apart from it."""
    for b in range(layer[other], layer[other + 1]):
        if high[a] >= rest[b] and high[b] >= rest[a]:
            join(parent, a, b)
