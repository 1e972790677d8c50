"""The ground stage: from points to labels, heights and a surface (Alg. 2 in a robust frame)."""

from __future__ import annotations

from typing import Any

import numpy as np

from datmo.arrays import F32, F64, I32, Array, Bool
from datmo.bins import bin_edges
from datmo.errors import ConfigError, MessageError, nearest
from datmo.ground.coarse import Sheet
from datmo.ground.config import GroundConfig
from datmo.ground.grid import PolarGrid, candidates, locate
from datmo.ground.label import LimitRules, cell_means, label_points, limits
from datmo.ground.methods import METHODS, regression
from datmo.ground.plane import robust_plane
from datmo.ground.regression import Cells, Heights
from datmo.ground.seeds import expect_ground
from datmo.ground.surface import PolarSurface, gaps
from datmo.messages import Ground


def segment_ground(
    points: Array, method: str | None = None, config: GroundConfig | None = None, keep: Bool | None = None
) -> Ground:
    """Which points are ground, and the ground's height everywhere.

    Args:
        points: (n, 3) [m, sensor frame: x forward, y left, z up].
        method: a name of `METHODS`; None takes the config's ("z").
        config: thresholds; None takes the defaults.
        keep: (n,) points that take part (see `datmo.refine`); None takes all.

    Returns:
        Ground, see `GroundSegmenter.step`.

    Raises:
        ConfigError: unknown method. MessageError: points or keep of a wrong shape or type.
    """
    config = config or GroundConfig()
    if method is not None and method not in METHODS:
        raise ConfigError(f"ground method {method!r} is not known; {nearest(str(method), METHODS)}")
    if method is not None:
        config = config.model_copy(update={"method": method})
    return GroundSegmenter(config).step(points, keep)


def _rows(name: str, value: Any, dtype: Any, shape: tuple[int | None, ...]) -> Array:
    """`value` as an array of `dtype` whose shape is `shape`, None being any length."""
    try:
        with np.errstate(over="ignore"):  # beyond float32 is infinite, and so left out
            array = np.ascontiguousarray(value, dtype)
    except (TypeError, ValueError) as error:
        raise MessageError(f"{name}: {error}; give an array of numbers") from None
    if array.ndim != len(shape) or any(s not in (None, h) for s, h in zip(shape, array.shape, strict=True)):
        want = str(shape).replace("None", "n")
        raise MessageError(f"{name} has shape {array.shape}; it must be {want}; give one row a point")
    return array


class GroundSegmenter:
    """The ground stage of the pipeline, one sensor through time.

    Attributes:
        learned: hyper-parameters of the last frame, and what they were learned from; the next frame
            starts from them.
    """

    def __init__(self, config: GroundConfig | None = None) -> None:
        self.config = config or GroundConfig()
        c = self.config
        edges = bin_edges(c.bins, c.blind, c.radius)
        self._grid = PolarGrid(c.segments, edges)
        self._limits = LimitRules(
            c.point_height, c.point_range, c.point_slope, c.point_most, c.point_below, c.foot_factor
        )
        self._regression = regression(self._grid, c)
        self.learned = self._regression.start()

    def reset(self) -> None:
        """Forget what was learned; the next scan begins a new sequence."""
        self.learned = self._regression.start()

    def step(self, points: Array, keep: Bool | None = None) -> Ground:
        """The ground of one scan. Neither the order of the points nor copies of them matter.

        A point that is not kept, not finite, or outside the grid (nearer than `blind`, farther than
        `radius`, or further than that above or below) is not ground; its height is the surface's,
        NaN where its x or y is not finite. Without any usable point the surface is level at
        `start_height` with a deviation of `most_std`.

        Args:
            points: (n, 3) [m, sensor]. keep: (n,) points that take part; None takes all.

        Raises:
            MessageError: points or keep of a wrong shape or type.
        """
        points = _rows("points", points, np.float32, (None, 3))
        kept = np.ones(len(points), bool) if keep is None else _rows("keep", keep, bool, (len(points),))
        grid, config = self._grid, self.config
        cell, azimuth, radius = locate(points, kept, grid.edges, grid.segments)
        plane = self._plane(points, cell, radius)
        cells = candidates(points, cell, radius, plane, grid, config.multipath)
        expected = expect_ground(cells, grid, config)
        lowest = Cells(cells.r, expected.e, expected.usable)
        member, heights = self._regression.grow(lowest, expected.seed, expected.doubtful, self.learned)
        surface = self._surface(plane, expected.sheet, member, heights)
        x, y, z = points.T.astype(float)
        height, std = surface.at(x, y, azimuth, radius)
        is_ground = self._label(z - height, cell, surface)
        if config.refit:
            surface = self._refit(z - height, radius, cell, is_ground, surface, expected.sheet)
            height, std = surface.at(x, y, azimuth, radius)
            is_ground = self._label(z - height, cell, surface)
        return Ground(is_ground, height.astype(np.float32), std.astype(np.float32), surface)

    def _label(self, over: F64, cell: I32, surface: PolarSurface) -> Bool:
        """Which points at `over` the surface (n,) [m] are ground."""
        return label_points(over, cell, limits(surface, self._grid.centers, self._limits), self._limits)

    def _plane(self, points: F32, cell: I32, radius: F64) -> F64:
        """The local slope from the lowest points of the cells within `plane_radius`."""
        cells = candidates(points, cell, radius, np.zeros(3), self._grid, self.config.multipath)
        near = cells.present & (cells.r < self.config.plane_radius)
        return robust_plane(cells.xyz[near], self.config.start_height)

    def _surface(self, plane: F64, sheet: Sheet, seen: Bool, heights: Heights) -> PolarSurface:
        """h0 plus the regression's heights, joined.

        The deviation grows away from the cells (M, N) that were `seen`, and holds the part of the
        noise that the sensor's own does not explain: that is roughness within the cells, and so height.
        """
        grid, config = self._grid, self.config
        mean = heights.mean + sheet(grid.xy(grid.nodes)).reshape(heights.mean.shape)
        away = np.minimum(config.drift * gaps(seen, grid.centers, grid.nodes), config.most_std)
        rough = np.maximum(heights.noise - config.noise_floor**2, 0.0)
        std = np.sqrt(heights.var + rough + away**2)
        # All segments share the place of their first node, the sensor's foot.
        mean[:, 0], std[:, 0] = mean[:, 0].mean(), std[:, 0].mean()
        return PolarSurface(plane, grid.nodes, mean, std)

    def _refit(
        self, over: F64, radius: F64, cell: I32, is_ground: Bool, surface: PolarSurface, sheet: Sheet
    ) -> PolarSurface:
        """The surface through the mean of each cell's ground points, hyper-parameters learned."""
        grid = self._grid
        count, mean_over, mean_r = cell_means(over, radius, cell, is_ground, grid.shape[0] * grid.shape[1])
        use = (count > 0).reshape(grid.shape)
        r = np.where(use, mean_r.reshape(grid.shape), grid.centers)
        xy = grid.xy(r)
        a, b, c = surface.plane
        height = surface(xy)[0] - (a * xy[:, 0] + b * xy[:, 1] + c) - sheet(xy)
        y = np.where(use, mean_over.reshape(grid.shape) + height.reshape(grid.shape), 0)
        heights, self.learned = self._regression.fit(Cells(r, y, use), self.learned)
        return self._surface(surface.plane, sheet, use, heights)
