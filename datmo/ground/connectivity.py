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
def _steps(d: float, de: float, dz: float) -> bool:
    """Whether ground takes the steps de, dz over the distance d [m]."""
    most = STEP + STEP_SLOPE * d
    return bool(abs(dz) <= most and abs(de) <= min(most, STEP_MOST))


@numba.njit(cache=True, nogil=True)
def _join(parent: I32, a: int, b: int) -> None:
    """Make the sets of cells a and b one."""
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
        last, o = -1, m + 1 if m + 1 < M else 0
        for b in range(N):
            if not low[m, b]:
                continue
            rb, eb, zb = r[m, b], e[m, b], z[m, b]
            near = last >= 0 and rb - r[m, last] <= REACH + REACH_SLOPE * rb
            if near and _steps(rb - r[m, last], eb - e[m, last], zb - z[m, last]):
                _join(parent, m * N + last, m * N + b)
            last = b
            for c in range(max(b - SIDE, 0), min(b + SIDE + 1, N)):
                if low[o, c]:
                    d = np.sqrt((rb - r[o, c]) ** 2 + (width * rb) ** 2)
                    if _steps(d, eb - e[o, c], zb - z[o, c]):
                        _join(parent, m * N + b, o * N + c)
    label = np.full((M, N), -1, np.int32)
    for i in range(M * N):
        if low.flat[i]:
            label.flat[i] = _root(parent, i)
    return label


@numba.njit(cache=True, nogil=True)
def connected(r: F64, label: I32, area: F64) -> Bool:
    """Cells (M, N) of the ground's components: those of more than a car's area that reach within 20 m
    of the sensor, or without any the largest one.

    Args:
        r: (M, N) [m]. label: (M, N) of `components`. area: (N,) of a cell in each bin [m²].
    """
    M, N = label.shape
    size, nearest = np.zeros(M * N), np.full(M * N, np.inf)
    for m in range(M):
        for b in range(N):
            k = label[m, b]
            if k >= 0:
                size[k] += area[b]
                nearest[k] = min(nearest[k], r[m, b])
    ground = (nearest < NEAR) & (size >= LARGE_AREA)
    if not ground.any():
        ground[np.argmax(size)] = True
    return _cells_of(label, ground)


@numba.njit(cache=True, nogil=True)
def _cells_of(label: I32, chosen: Bool) -> Bool:
    """Cells (M, N) of the components `chosen` (M * N,) by their number."""
    out = np.zeros(label.shape, np.bool_)
    for m in range(label.shape[0]):
        for b in range(label.shape[1]):
            out[m, b] = label[m, b] >= 0 and chosen[label[m, b]]
    return out


@numba.njit(cache=True, nogil=True)
def readmitted(label: I32, kept: Bool, e: F64, area: F64) -> Bool:
    """Cells (M, N) of components left out that are ground after all: most of their cells lie on the
    surface drawn without them, or they are larger than a car.

    Args:
        label: (M, N). kept: (M, N) of `connected`. e: (M, N) height over the surface drawn without
        the others [m]. area: (N,) of a cell in each bin [m²].
    """
    M, N = label.shape
    count, on, extent = np.zeros(M * N, np.int64), np.zeros(M * N, np.int64), np.zeros(M * N)
    for m in range(M):
        for b in range(N):
            k = label[m, b]
            if k >= 0 and not kept[m, b]:
                count[k] += 1
                extent[k] += area[b]
                on[k] += abs(e[m, b]) < STEP
    back = (2 * on > count) | ((extent >= LARGE_AREA) & (2 * count >= LARGE_CELLS))
    return _cells_of(label, back)
