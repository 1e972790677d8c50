"""Elevated points to clusters."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from datmo.arrays import I32, Array, Bool
from datmo.clusters.config import ClusterConfig
from datmo.clusters.connect import connect_plain, connect_polar
from datmo.clusters.grid import PolarGrid, polar_grid
from datmo.clusters.layers import find_layers, label_points
from datmo.errors import MessageError
from datmo.messages import Clusters


def cluster(
    points: Array, height_above: Array, elevated: Bool, config: ClusterConfig | None = None
) -> Clusters:
    """Connected components of the cells that hold elevated points (method.md section 5, Alg. 8).

    Points from `min_height` above the ground on occupy cells and link them, layer by layer: what hangs
    (foliage, bridges) does not link with what stands below it. Lower points (feet, tyres, kerbs) link
    nothing, but take the label of what stands in their cell. So a kerb does not tie two cars together,
    nor a crown a person to a tree. Without layers, which the plain grid never has, points higher than
    `max_height` belong to no cluster instead.

    Args:
        points: (n, 3) [m], seen from the sensor: range is counted from the origin of x-y.
        height_above: (n,) of each point above the ground under it [m].
        elevated: (n,) the points that are kept and not ground.
        config: settings.

    Returns:
        Clusters, labelled by their lowest cell, then their lowest layer: the order of the points does not
        matter. Points that are not finite, or out of range, have label -1.

    Raises:
        MessageError: the arrays do not have one row a point.
    """
    config = config or ClusterConfig()
    points, height_above = np.asarray(points), np.asarray(height_above)
    _check(points, height_above, elevated)
    in_layers = config.layers and config.grid == "polar"
    taken = elevated & (height_above < (np.inf if in_layers else config.max_height))
    components = _polar if config.grid == "polar" else _plain
    label = components(points, height_above, taken, config)
    return Clusters(label=label, count=int(label.max(initial=-1)) + 1)


def _polar(points: Array, height_above: Array, taken: Bool, config: ClusterConfig) -> I32:
    grid = _grid(config)
    cell = grid.locate(points, taken)
    layers = find_layers(cell, height_above, grid, config)
    return label_points(connect_polar(layers, grid), layers, cell, height_above, config)


def _plain(points: Array, height_above: Array, taken: Bool, config: ClusterConfig) -> I32:
    label = np.full(len(points), -1, np.int32)
    half = int(np.ceil(config.max_range / config.cell))
    rows = np.flatnonzero(
        taken & np.isfinite(points[:, 2]) & (np.abs(points[:, :2]) < config.max_range).all(1)
    )
    column = np.floor(points[rows, :2] / config.cell).astype(np.int64) + half
    occupied = np.zeros((2 * half, 2 * half), np.bool_)
    occupied[tuple(column[height_above[rows] >= config.min_height].T)] = True
    label[rows] = connect_plain(occupied)[tuple(column.T)]
    return label


@lru_cache(maxsize=8)
def _grid(config: ClusterConfig) -> PolarGrid:
    return polar_grid(config)


def _check(points: Array, height_above: Array, elevated: Bool) -> None:
    n = len(points)
    if points.shape != (n, 3) or height_above.shape != (n,) or np.shape(elevated) != (n,):
        raise MessageError(
            f"cluster was given points {points.shape}, height_above {height_above.shape} and elevated "
            f"{np.shape(elevated)}; they must be (n, 3), (n,) and (n,); give one row a point"
        )
