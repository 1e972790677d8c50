"""One Gaussian process a segment: growth and heights, whatever gives length-scales and noise."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, Bool
from datmo.ground.config import GroundConfig
from datmo.ground.gp import fit_segments, grow_segments
from datmo.ground.grid import PolarGrid
from datmo.ground.lines import LineRules, as_array
from datmo.ground.regression import Cells, Heights, Learned, Regression
from datmo.threads import over_rows

ABOVE = 1.0
DOUBT = 20.0


@dataclass(frozen=True)
class Scales:
    """All that prediction needs.

    Attributes:
        L: (M, N), L_nodes: (M, Q) length-scales of cells and nodes [m]. noise: (M, N), noise_nodes:
        (M, Q) variance of an observation [m²]. sf: σ_f [m].
    """

    L: F64
    L_nodes: F64
    noise: F64
    noise_nodes: F64
    sf: float


class Segments(Regression):
    """One process a segment. How length-scales and noise come about is up to the method."""

    def __init__(self, grid: PolarGrid, config: GroundConfig) -> None:
        self.grid, self.config, self.nodes = grid, config, grid.nodes
        c = config
        self.line_rules = as_array(
            LineRules(c.line_join, c.line_turn, c.slope_max, c.line_rmse, c.line_small, c.line_intercept)
        )

    @abstractmethod
    def scales(self, cells: Cells, learned: Learned) -> Scales:
        """Scales of these cells by what is known already."""

    @abstractmethod
    def learn(self, cells: Cells, learned: Learned) -> tuple[Scales, Learned]:
        """Scales of these cells, learned from them."""

    def grow(self, cells: Cells, seed: Bool, doubtful: Bool, learned: Learned) -> tuple[Bool, Heights]:
        """See `Regression`.

        Noise and σ_f are at least those of the config: what was learned from the ground alone would
        not let rougher ground join. A doubtful candidate has twenty times the variance. The variance
        of the heights is taken only where no refit follows.
        """
        config, known = self.config, self.scales(cells, learned)
        usual = np.maximum(known.noise, config.noise_std**2)
        sf = max(known.sf, config.signal_std)
        noise = np.where(doubtful, DOUBT, 1.0) * usual
        above = ABOVE if config.asymmetric else 0.0
        member, mean = np.zeros(cells.r.shape, bool), np.zeros(cells.r.shape)
        rows = (cells.r, cells.y, known.L, noise, cells.use, seed, member, mean)
        rules = np.array([sf**2, config.join_variance, config.join_distance])
        over_rows(grow_segments, rows, (above, rules))
        noise = noise + (above * np.maximum(cells.y - mean, 0)) ** 2
        joined = Scales(known.L, known.L_nodes, noise, np.maximum(known.noise_nodes, config.noise_std**2), sf)
        return member, self._heights(cells.narrow(member), joined, not config.refit)

    def fit(self, cells: Cells, learned: Learned) -> tuple[Heights, Learned]:
        """See `Regression`."""
        if self.config.learn:
            scales, learned = self.learn(cells, learned)
        else:
            scales = self.scales(cells, learned)
        return self._heights(cells, scales, True), learned

    def _heights(self, cells: Cells, scales: Scales, spread: bool) -> Heights:
        """The processes at the nodes; the variance is 0 unless `spread`."""
        shape = len(cells.r), len(self.nodes)
        mean, var = np.zeros(shape), np.zeros(shape)
        rows = (cells.r, cells.y, scales.L, scales.noise, cells.use, scales.L_nodes, mean, var)
        over_rows(fit_segments, rows, (self.nodes, scales.sf**2, spread))
        # What the sensor's own noise does not explain is roughness within the cells, and so height.
        rough = np.maximum(scales.noise_nodes - self.config.noise_floor**2, 0.0)
        return Heights(mean, var + rough, scales.noise_nodes)
