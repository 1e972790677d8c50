"""From what a scenario says about its ground to the ground."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from datmo.arrays import F64, U8, Bool
from datmo.messages import Kind
from scenarios import spec
from scenarios.spec import layers as kinds
from sim.scene.roads import Road, beyond_edge
from sim.scene.roughness import rough_fields
from sim.scene.terrain import cache, far, roadside, shapes, strewn
from sim.scene.terrain.bank import lean
from sim.scene.terrain.file import under
from sim.scene.terrain.grid import Area, Grid, grid_over
from sim.scene.terrain.surface import Terrain

FIELD, ROAD, LAYERS = 0, 1, 2
"""The streams of luck: of the field, of the road, and the first of the layers'."""


def build_terrain(
    terrain: spec.Terrain, roads: Sequence[Road], area: Area, seed: np.random.SeedSequence
) -> Terrain:
    """The ground of a scenario: the sum of a plane, a file, the layers and two roughnesses.

    The field's roughness lies outside the roads and another, independent, one on them; the one
    turns into the other over `terrain.shoulder` metres beyond the road's edge, or beyond the
    sidewalk. A ground once built is taken from the cache on disk, byte for byte.

    Args:
        area: x_min, y_min, x_max, y_max [m, world]; the grid covers it.

    Raises:
        SimulationError: the area is empty, not finite, or too large for its cell.
        ScenarioError: the file of the ground is missing, broken or too small.
    """
    grid = grid_over(area, terrain.cell)
    key = cache.key_of(terrain, roads, grid, seed)
    coarse = far.coarse_tiles(roads, grid, _coarse_beyond(terrain))
    height, kind = cache.kept(key, grid.shape, lambda: _raise(terrain, roads, grid, coarse, seed))
    return Terrain(
        grid.x0,
        grid.y0,
        grid.cell,
        height.astype(float),
        kind,
        roughness=terrain.roughness,
        road_roughness=terrain.road_roughness,
        coarse=coarse,
    )


def _coarse_beyond(terrain: spec.Terrain) -> float | None:
    """How far from the roads the coarse mesh begins [m]: beyond all that goes with them."""
    if terrain.coarse_beyond is None:
        return None
    return max(terrain.coarse_beyond, roadside.depth_of_interest(terrain.layers, terrain.shoulder))


def _raise(
    terrain: spec.Terrain,
    roads: Sequence[Road],
    grid: Grid,
    coarse: Bool | None,
    seed: np.random.SeedSequence,
) -> tuple[F64, U8]:
    """Heights of the nodes and kinds of the cells."""
    reach = roadside.depth_of_interest(terrain.layers, terrain.shoulder)
    beyond = beyond_edge(roads, grid.shape, (grid.x0, grid.y0), grid.cell, reach)
    sidewalk = next((k.sidewalk + roadside.GUTTER for k in terrain.layers if isinstance(k, kinds.Kerb)), 0.0)
    if roads and sidewalk:
        beyond = roadside.paved(beyond, grid)
    share = roadside.smooth_step((beyond - sidewalk) / terrain.shoulder)
    draws = [(terrain.roughness, _stream(seed, FIELD)), (terrain.road_roughness, _stream(seed, ROAD))]
    rough = rough_fields(grid.shape, grid.cell, draws if roads else draws[:1])
    height = share * rough[0]
    if roads:
        height += (1 - share) * rough[1]
    height += terrain.grade * grid.y
    height += terrain.cross_slope * grid.x
    if terrain.file is not None:
        height += under(terrain.file, grid)
    for layer, luck in _with_luck(terrain.layers, seed):
        _add(layer, height, grid, roads, beyond, share, luck)
    far.flatten(height, coarse)
    return height, _kinds(beyond, sidewalk)


def _add(
    layer: kinds.Layer,
    height: F64,
    grid: Grid,
    roads: Sequence[Road],
    beyond: F64,
    share: F64,
    luck: np.random.SeedSequence,
) -> None:
    """Add one layer to the heights, in place."""
    if isinstance(layer, kinds.Hills):
        for hill in strewn.hills(layer, grid.area, luck):
            _stamp(hill, height, grid)
    elif isinstance(layer, kinds.Potholes):
        for hole in strewn.potholes(layer, grid.area, luck):
            if layer.on == "all" or (_at(beyond, grid, hole.at) <= 0) == (layer.on == "road"):
                _stamp(hole, height, grid)
    elif isinstance(layer, kinds.Bank):
        height += lean(layer, roads, grid)
    elif isinstance(layer, kinds.Kerb):
        if roads:
            height += roadside.kerb(layer, beyond, grid.cell)
    elif isinstance(layer, kinds.Ditch):
        if roads or layer.path is not None:
            height += roadside.ditch(layer, beyond, share, grid)
    else:
        _stamp(layer, height, grid)


def _stamp(layer: Any, height: F64, grid: Grid) -> None:
    """Add a placed layer where it reaches."""
    (x, y), room = layer.at, shapes.reach(layer)
    window = slice(None), slice(None)
    if np.isfinite(room):
        window = grid.window((x - room, y - room, x + room, y + room))
    height[window] += shapes.height(layer, grid.x[:, window[1]], grid.y[window[0]], grid.cell)


def _at(values: F64, grid: Grid, at: tuple[float, float]) -> float:
    """The value of the node nearest to a place."""
    i = int(np.clip(round((at[0] - grid.x0) / grid.cell), 0, grid.nx - 1))
    j = int(np.clip(round((at[1] - grid.y0) / grid.cell), 0, grid.ny - 1))
    return float(values[j, i])


def _with_luck(
    layers: Sequence[kinds.Layer], seed: np.random.SeedSequence
) -> list[tuple[kinds.Layer, np.random.SeedSequence]]:
    """Each layer with a stream of its own, told by its kind and how many of it came before.

    So no layer changes the luck of one of another kind, nor of an earlier one.
    """
    seen: dict[str, int] = {}
    pairs = []
    for layer in layers:
        before = seen.get(layer.kind, 0)
        seen[layer.kind] = before + 1
        pairs.append((layer, _stream(seed, LAYERS, *layer.kind.encode(), before)))
    return pairs


def _stream(seed: np.random.SeedSequence, *lot: int) -> np.random.SeedSequence:
    return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, *lot))


def _kinds(beyond: F64, sidewalk: float) -> U8:
    """Kind of each cell, by the mean of its corners' distance beyond the roads' edge."""
    mean = (beyond[1:, 1:] + beyond[:-1, :-1] + beyond[1:, :-1] + beyond[:-1, 1:]) / 4
    paved = np.where(mean <= 0, Kind.ROAD, Kind.SIDEWALK)
    return np.where(mean <= sidewalk, paved, Kind.FIELD).astype(np.uint8)
