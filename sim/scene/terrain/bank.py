"""Roads that lean into their bends.

The super-elevation of a bend of curvature κ, driven at v with side friction f, is e = v²κ/g - f (AASHTO,
A Policy on Geometric Design of Highways and Streets, ch. 3), at most `limit`. A carriageway turns as one
plane about its middle lane: at t metres to the left of that lane's centreline it stands -e t higher,
e positive in a bend to the left.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numba import njit
from scipy.ndimage import uniform_filter1d

from datmo.arrays import F64
from scenarios.spec import layers as spec
from sim.scene.carriageways import JOINT, STEP, Carriageway, carriageways
from sim.scene.roads import Road
from sim.scene.terrain.grid import Grid

G = 9.81  # [m/s²]
SMOOTH = 5  # curvature is a mean over so many points


@njit(cache=True, nogil=True)
def _nearest(
    line: F64, reach: float, x0: float, y0: float, cell: float, best: F64, left: F64, place: F64
) -> None:
    """Of the line's nearest point within `reach`: squared distance, offset to its left, place in segments."""
    ny, nx = best.shape
    for s in range(len(line) - 1):
        ax, ay = line[s]
        bx, by = line[s + 1]
        ex, ey = bx - ax, by - ay
        square = max(ex * ex + ey * ey, 1e-18)
        i0, i1 = (min(ax, bx) - reach - x0) / cell, (max(ax, bx) + reach - x0) / cell
        j0, j1 = (min(ay, by) - reach - y0) / cell, (max(ay, by) + reach - y0) / cell
        for j in range(max(int(j0), 0), min(int(j1) + 2, ny)):
            for i in range(max(int(i0), 0), min(int(i1) + 2, nx)):
                px, py = x0 + i * cell - ax, y0 + j * cell - ay
                t = min(max((px * ex + py * ey) / square, 0.0), 1.0)
                away = (px - t * ex) ** 2 + (py - t * ey) ** 2
                if away < best[j, i]:
                    best[j, i], place[j, i] = away, s + t
                    left[j, i] = (ex * py - ey * px) / np.sqrt(square)


def lean(layer: spec.Bank, roads: Sequence[Road], grid: Grid) -> F64:
    """Heights (ny, nx) [m]; where carriageways cross or meet, the mean of theirs by nearness."""
    ways = carriageways(roads)
    rates = [super_elevation(way.line, layer) for way in ways]
    height, weight = np.zeros(grid.shape), np.zeros(grid.shape)
    if not any(rate.any() for rate in rates):
        return height
    for way, rate in zip(ways, rates, strict=True):
        _tilt(way, rate, layer.verge, grid, height, weight)
    return np.asarray(height / np.maximum(weight, 1.0))


def super_elevation(line: F64, layer: spec.Bank) -> F64:
    """e (m,) [m/m] at the points of a centreline, built up over the run-off and 0 at free ends."""
    ring = len(line) > 3 and bool(np.hypot(*(line[0] - line[-1])) < JOINT)
    mode: Literal["wrap", "nearest"] = "wrap" if ring else "nearest"
    step = np.diff(line, axis=0)
    heading, length = np.arctan2(step[:, 1], step[:, 0]), np.hypot(*step.T)
    turn = np.angle(np.exp(1j * (heading - np.roll(heading, 1))))  # at the first point of each segment
    if not ring:
        turn[0] = turn[min(1, len(turn) - 1)]
    curvature = uniform_filter1d(turn / length, SMOOTH, mode=mode)
    needed = layer.speed**2 * np.abs(curvature) / G - layer.side_friction
    e = np.clip(needed, 0, layer.limit) * np.sign(curvature)
    e = uniform_filter1d(e, max(round(layer.runoff / STEP), 1), mode=mode)
    e = np.append(e, e[0] if ring else 0.0)
    if not ring:
        arc = np.concatenate([[0.0], np.cumsum(length)])
        e *= np.clip(np.minimum(arc, arc[-1] - arc) / layer.runoff, 0.0, 1.0)
    return np.asarray(e)


def _tilt(way: Carriageway, rate: F64, verge: float, grid: Grid, height: F64, weight: F64) -> None:
    """Add a carriageway's height, weighted, and its weight: 1 on it, fading to 0 over the verge."""
    reach = max(way.left, way.right) + verge
    (x0, y0), (x1, y1) = way.line.min(0) - reach, way.line.max(0) + reach
    rows, columns = grid.window((x0, y0, x1, y1))
    shape = rows.stop - rows.start, columns.stop - columns.start
    if not all(shape):
        return
    best, left, place = np.full(shape, np.inf), np.zeros(shape), np.zeros(shape)
    corner = grid.x0 + columns.start * grid.cell, grid.y0 + rows.start * grid.cell
    _nearest(way.line, reach, *corner, grid.cell, best, left, place)
    e = np.interp(place, np.arange(len(rate)), rate)
    past = np.sqrt(np.maximum(best - left * left, 0.0))  # beyond an end of the line
    beyond = np.maximum(np.maximum(left - way.left, -way.right - left), past)
    fade = np.clip(beyond / verge, 0.0, 1.0)
    share = np.where(np.isfinite(best), 1 - fade * fade * (3 - 2 * fade), 0.0)
    height[rows, columns] += share * -e * np.clip(left, -way.right, way.left)
    weight[rows, columns] += share
