"""Low cells that connect to the ground about the sensor; the rest do not carry the surface."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, I32, Bool

STEP, STEP_SLOPE, STEP_MOST = 0.15, 0.35, 0.3
NEAR, LARGE_CELLS, LARGE_AREA = 20.0, 30, 12.0
REACH, REACH_SLOPE = 1.0, 0.2
SIDE = 2


@numba.njit(cache=True, nogil=True)
def _root(parent: I32, i: int) -> int:
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@numba.njit(cache=True, nogil=True)
def _link(parent: I32, a: int, b: int, d: float, de: float, dz: float) -> None:
    """Join the sets of cells a, b if the steps de, dz over the distance d are such as ground takes."""
    most = STEP + STEP_SLOPE * d
    if abs(dz) <= most and abs(de) <= min(most, STEP_MOST):
        a, b = _root(parent, a), _root(parent, b)
        parent[max(a, b)] = min(a, b)


@numba.njit(cache=True, nogil=True)
def components(r: F64, e: F64, z: F64, low: Bool) -> I32:
    """Component (M, N) of each low cell, named by its first cell; -1 where not low.

    Neighbours are the next low cell outwards within reach, and cells of the next segment at most
    two bins off; they link when |Δz| <= 0.15 + 0.35 d and |Δe| is that too and at most 0.3.

    Args:
        r: (M, N) range of the candidate [m]. e: (M, N) height over the expected ground, and z: over
        the plane [m].
    """
    M, N = r.shape
    parent = np.arange(M * N).astype(np.int32)
    width = 2 * np.pi / M
    for m in range(M):
        last = -1
        for b in range(N):
            if not low[m, b]:
                continue
            if last >= 0 and r[m, b] - r[m, last] <= REACH + REACH_SLOPE * r[m, b]:
                _link(
                    parent,
                    m * N + last,
                    m * N + b,
                    r[m, b] - r[m, last],
                    e[m, b] - e[m, last],
                    z[m, b] - z[m, last],
                )
            last = b
            o = (m + 1) % M
            for c in range(max(b - SIDE, 0), min(b + SIDE + 1, N)):
                if low[o, c]:
                    d = np.hypot(r[m, b] - r[o, c], width * r[m, b])
                    _link(parent, m * N + b, o * N + c, d, e[m, b] - e[o, c], z[m, b] - z[o, c])
    label = np.full((M, N), -1, np.int32)
    for i in range(M * N):
        if low.flat[i]:
            label.flat[i] = _root(parent, i)
    return label


def connected(r: F64, label: I32, area: F64) -> Bool:
    """Cells (M, N) of the ground's components: those of more than a car's area that reach within 20 m
    of the sensor, or without any the largest one.

    Args:
        r: (M, N) [m]. label: (M, N) of `components`. area: (N,) of a cell in each bin [m²].
    """
    low = label >= 0
    names, at = np.unique(label[low], return_inverse=True)
    size = np.bincount(at, np.broadcast_to(area, label.shape)[low], len(names))
    nearest = np.full(len(names), np.inf)
    np.minimum.at(nearest, at, r[low])
    ground = (nearest < NEAR) & (size >= LARGE_AREA)
    if len(names) and not ground.any():
        ground[np.argmax(size)] = True
    kept = np.zeros(label.shape, bool)
    kept[low] = ground[at]
    return kept


def readmitted(label: I32, kept: Bool, e: F64, area: F64) -> Bool:
    """Cells (M, N) of components left out that are ground after all: most of their cells lie on the
    surface drawn without them, or they are larger than a car.

    Args:
        label: (M, N). kept: (M, N) of `connected`. e: (M, N) height over the surface drawn without
        the others [m]. area: (N,) of a cell in each bin [m²].
    """
    out = (label >= 0) & ~kept
    names, at = np.unique(label[out], return_inverse=True)
    count = np.bincount(at, minlength=len(names))
    extent = np.bincount(at, np.broadcast_to(area, label.shape)[out], len(names))
    on = np.bincount(at, np.abs(e[out]) < STEP, len(names))
    back = (2 * on > count) | ((extent >= LARGE_AREA) & (2 * count >= LARGE_CELLS))
    cells = np.zeros(label.shape, bool)
    cells[out] = back[at]
    return cells
