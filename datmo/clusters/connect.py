"""Connected components of occupied cells, 8-neighbourhood: two passes with union-find.

Labels follow the lowest cell of each component, so they do not depend on the order of the points.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.ndimage import label as label_image

from datmo.arrays import I32, I64, Bool
from datmo.clusters.grid import PolarGrid


def connect_polar(occupied: Bool, grid: PolarGrid) -> I32:
    """Component (size,) of each cell of a polar grid, -1 where empty; cells that touch are neighbours."""
    return np.asarray(_connect(occupied, grid.columns, grid.first))


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
def _connect(occupied: Bool, columns: I64, first: I64) -> I32:
    parent = np.where(occupied, np.arange(len(occupied)), -1).astype(np.int32)
    for ring in range(len(columns)):
        n, start = columns[ring], first[ring]
        for j in range(n):
            cell = start + j
            if not occupied[cell]:
                continue
            beside = start + (j - 1) % n
            if occupied[beside]:
                _join(parent, cell, beside)
            if ring == 0:
                continue
            # Columns of the ring inside whose closed azimuth interval meets [j, j + 1] / n.
            m = columns[ring - 1]
            for k in range(-((-j * m) // n) - 1, ((j + 1) * m) // n + 1):
                inside = first[ring - 1] + k % m
                if occupied[inside]:
                    _join(parent, cell, inside)
    label = np.full(len(parent), -1, np.int32)
    count = 0
    for cell in range(len(parent)):  # a root is the lowest cell of its component: it comes first
        if parent[cell] == cell:
            label[cell] = count
            count += 1
        elif parent[cell] >= 0:
            label[cell] = label[parent[cell]]
    return label


@njit(cache=True, nogil=True)
def _join(parent: I32, a: int, b: int) -> None:
    while parent[a] != a:
        parent[a] = parent[parent[a]]
        a = parent[a]
    while parent[b] != b:
        parent[b] = parent[parent[b]]
        b = parent[b]
    if a < b:
        parent[b] = a
    else:
        parent[a] = b
