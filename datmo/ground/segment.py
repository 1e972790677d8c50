"""The ground stage: from points to labels, heights and a surface (Alg. 2 in a robust frame)."""

from __future__ import annotations

from typing import Any

import numpy as np

from datmo.arrays import F64, I32, Array, Bool
from datmo.bins import bin_edges
from datmo.errors import ConfigError, MessageError, nearest
from datmo.ground.config import GroundConfig
from datmo.ground.grid import Candidates, Located, PolarGrid
from datmo.ground.label import LimitRules, cell_means, label_points, limits
from datmo.ground.lattice import corners, evaluate
from datmo.ground.methods import METHODS, regression
from datmo.ground.plane import robust_plane
from datmo.ground.regression import Cells, Heights
from datmo.ground.seeds import GroundExpectation
from datmo.ground.sheet import Sheet, coarse_lattice, learned_bend
from datmo.ground.surface import PolarSurface, at_cells, gaps
from datmo.messages import Ground

# What is unseen strays by DRIFT times the sheet's turn times the distance d to what was seen, and behind a
# hill by HIDDEN [1/m] times its lean times d²; fitted as in `field`.
DRIFT, HIDDEN = 0.5, 0.7
BEND_RADIUS = 50.0  # [m]
NOTHING = 1e6  # m, farther than any grid reaches
LEAST_NOISE = 0.001**2  # of a cell's mean: the calibration of rings against each other [m²]


def segment_ground(
    points: Array, method: str | None = None, config: GroundConfig | None = None, keep: Bool | None = None
) -> Ground:
    """Which points are ground, and the ground's height everywhere.

    Args:
        points: (n, 3) [m, sensor frame: x forward, y left, z up].
        method: a name of `METHODS`; None takes the config's ("default").
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
            c.point_height,
            c.point_range,
            c.point_slope,
            c.point_most,
            c.point_below,
            c.foot_factor,
            c.point_noise,
        )
        self._expect = GroundExpectation(self._grid, c)
        lattice = coarse_lattice(c.segments, self._grid.centers)
        self._nodes = corners(*self._grid.node_places, lattice.lines, c.segments, lattice.radii)
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
        located = Located(points, kept, grid)
        cells = located.candidates(config.multipath)
        plane = self._plane(cells)
        expected = self._expect(cells, plane)
        level = evaluate(expected.sheet.f, *self._nodes).reshape(grid.segments, -1)
        lowest = Cells(cells.r, expected.e, expected.usable, cells.azimuth)
        seen, heights = self._regression.grow(lowest, expected.seed, expected.doubtful, self.learned)
        if config.refit:
            over = PolarSurface(plane, grid.nodes, level + heights.mean, heights.var).below(located)
            is_ground = self._label(over, located.cell, level, heights)
            seen, heights = self._refit(located, over, is_ground, heights.mean)
        surface = self._surface(plane, expected.sheet, level, seen, heights)
        over, std = surface.below_with_std(located)
        is_ground = self._label(over, located.cell, level, heights)
        with np.errstate(invalid="ignore"):  # a point at an infinite height has none of its own
            height = (points[:, 2] - over).astype(np.float32)
        return Ground(is_ground, height, std, surface)

    def _label(self, over: F64, cell: I32, level: F64, heights: Heights) -> Bool:
        """Which points at `over` the surface (n,) [m] are ground; it lies at level + heights."""
        both = limits(level + heights.mean, heights.noise, self._grid.nodes, self._limits)
        return label_points(over, cell, *both, self._limits)

    def _plane(self, cells: Candidates) -> F64:
        """The local slope from the lowest points of the cells within `plane_radius`."""
        near = cells.present & (cells.r < self.config.plane_radius)
        xyz = np.column_stack([cells.x[near], cells.y[near], cells.z[near]])
        return robust_plane(xyz, self.config.start_height)

    def _refit(self, located: Located, over: F64, is_ground: Bool, mean: F64) -> tuple[Bool, Heights]:
        """The heights through the mean of each cell's ground points, hyper-parameters learned.

        Args:
            over: (n,) height of the points over the first surface [m]. mean: (M, Q) of that over h0 [m].

        Returns:
            the cells (M, N) that hold ground, and the heights.
        """
        means = cell_means(located, over, is_ground, LEAST_NOISE)
        y = np.where(means.use, means.over + at_cells(mean, self._grid.nodes, means.azimuth, means.r), 0.0)
        cells = Cells(means.r, y, means.use, means.azimuth, means.noise)
        heights, self.learned = self._regression.fit(cells, self.learned)
        return means.use, heights

    def _surface(self, plane: F64, sheet: Sheet, level: F64, seen: Bool, heights: Heights) -> PolarSurface:
        """The sheet's `level` at the nodes and the regression's heights, joined; the deviation grows away
        from the cells (M, N) that were seen, faster the more the sheet bends and leans."""
        grid, config = self._grid, self.config
        turn, lean = learned_bend(sheet, seen, BEND_RADIUS)
        d = np.minimum(gaps(seen, grid.centers, grid.nodes), NOTHING)
        away = np.hypot(max(DRIFT * turn, config.drift) * d, HIDDEN * lean * d**2)
        away = np.where(d < NOTHING, np.minimum(away, config.most_std), config.most_std)
        mean, std = level + heights.mean, np.sqrt(heights.var + away**2)
        # All segments share the place of their first node, the sensor's foot.
        mean[:, 0], std[:, 0] = mean[:, 0].mean(), std[:, 0].mean()
        return PolarSurface(plane, grid.nodes, mean, std)
