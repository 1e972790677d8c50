"""The methods z and z-se: one process a segment, length-scales from its lines or all equal."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, I32, Bool
from datmo.ground.config import GroundConfig
from datmo.ground.gp import evidence, fit_segments, grow_segments
from datmo.ground.grid import PolarGrid
from datmo.ground.lines import LineRules, as_array, segment_slopes
from datmo.ground.regression import Cells, Heights, Learned, Regression
from datmo.ground.threads import each, over_rows

LEARNING_SEGMENTS = 8
RATIOS = (0.05, 0.1, 0.2, 0.3, 0.45, 0.7, 1.0)
FACTORS = (0.25, 0.5, 1.0, 2.0, 4.0)
ABOVE = 1.0
DOUBT = 20.0


@dataclass(frozen=True)
class Hyper:
    """scale: a of (3.11) [m], or ℓ of the stationary kernel [m]; sf: σ_f [m]; sn: σ_n [m]."""

    scale: float
    sf: float
    sn: float


@dataclass(frozen=True)
class Lengths:
    """Length-scale per unit `Hyper.scale` of each candidate (M, N) and node (M, Q); lines (M,)."""

    at: F64
    at_nodes: F64
    lines: I32


def learn(cells: Cells, shape: F64, start: Hyper, floor: float) -> Hyper:
    """Hyper-parameters of the largest marginal likelihood over the fullest segments of a frame.

    A grid over scale and σ_n / σ_f; for each, the best σ_f² is yᵀ (A / σ_f²)⁻¹ y / n, in closed
    form. Without data `start` stays.

    Args:
        shape: (M, N) length-scale per unit scale. floor: smallest σ_n [m].
    """
    count = cells.use.sum(1)
    # Of equally full segments the farthest-reaching come first, so that turning changes nothing.
    rows = np.lexsort((-(cells.r * cells.use).sum(1), -count))[:LEARNING_SEGMENTS]
    rows = rows[count[rows] >= 3]
    n = int(count[rows].sum())
    if not n:
        return start

    def profile(choice: tuple[float, float]) -> tuple[float, float]:
        scale, ratio = choice
        noise = np.full(cells.r.shape, ratio**2)
        square, log_det = evidence(cells.r, cells.y, scale * shape, noise, cells.use, rows)
        sf2 = max(square / n, 1e-8)
        return -0.5 * (n * float(np.log(sf2)) + log_det), sf2

    choices = [(factor * start.scale, ratio) for factor in FACTORS for ratio in RATIOS]
    found = each(profile, choices)
    best = max(range(len(found)), key=lambda k: found[k][0])
    (scale, ratio), sf = choices[best], float(np.sqrt(found[best][1]))
    return Hyper(scale, sf, max(sf * ratio, floor))


class Segments(Regression):
    """One process a segment; how long its length-scales are, relative to a learned scale, is up to
    the method."""

    def __init__(self, grid: PolarGrid, config: GroundConfig) -> None:
        self._nodes, self.config = grid.nodes, config
        self._start = Hyper(self._scale(config), config.signal_std, config.noise_std)

    @abstractmethod
    def _scale(self, config: GroundConfig) -> float:
        """The scale before any learning [m]."""

    @abstractmethod
    def _lengths(self, cells: Cells) -> Lengths:
        """Length-scales per unit scale."""

    def start(self) -> Learned:
        """See `Regression`."""
        none = np.zeros(0, np.int32)
        return self._learned(self._start, none, none)

    def grow(self, cells: Cells, seed: Bool, doubtful: Bool, learned: Learned) -> tuple[Bool, Heights]:  # noqa: ARG002
        """See `Regression`; hyper-parameters are those of the config.

        A doubtful candidate has twenty times the variance.
        """
        config, hyper, lengths = self.config, self._start, self._lengths(cells)
        noise = np.where(doubtful, DOUBT, 1.0) * hyper.sn**2
        rules = np.array([hyper.sf**2, config.join_variance, config.join_distance])
        above = ABOVE if config.asymmetric else 0.0
        member, mean = np.zeros(cells.r.shape, bool), np.zeros(cells.r.shape)
        rows = (cells.r, cells.y, hyper.scale * lengths.at, noise, cells.use, seed, member, mean)
        over_rows(grow_segments, rows, (above, rules))
        noise = noise + (above * np.maximum(cells.y - mean, 0)) ** 2
        return member, self._heights(cells.narrow(member), noise, lengths, hyper)

    def fit(self, cells: Cells, learned: Learned) -> tuple[Heights, Learned]:  # noqa: ARG002
        """See `Regression`."""
        lengths, hyper = self._lengths(cells), self._start
        if self.config.learn:
            hyper = learn(cells, lengths.at, self._start, self.config.noise_floor)
        heights = self._heights(cells, np.full(cells.r.shape, hyper.sn**2), lengths, hyper)
        return heights, self._learned(hyper, cells.use.sum(1).astype(np.int32), lengths.lines)

    def _heights(self, cells: Cells, noise: F64, lengths: Lengths, hyper: Hyper) -> Heights:
        """The processes at the nodes; noise (M, N) is the variance of each cell's height [m²]."""
        shape = len(cells.r), len(self._nodes)
        mean, var = np.zeros(shape), np.zeros(shape)
        L, L_nodes = hyper.scale * lengths.at, hyper.scale * lengths.at_nodes
        rows = (cells.r, cells.y, L, noise, cells.use, L_nodes, mean, var)
        over_rows(fit_segments, rows, (self._nodes, hyper.sf**2))
        return Heights(mean, var, np.full(shape, hyper.sn**2))

    def _learned(self, hyper: Hyper, candidates: I32, lines: I32) -> Learned:
        named = {self.scale_name: hyper.scale, "sigma_f": hyper.sf, "sigma_n": hyper.sn}
        return Learned(named, candidates, lines)

    scale_name: str


class OneLength(Segments):
    """z-se, the stationary squared exponential (3.9): L = ℓ everywhere."""

    scale_name = "length"

    def _scale(self, config: GroundConfig) -> float:
        return config.length

    def _lengths(self, cells: Cells) -> Lengths:
        M, Q = len(cells.r), len(self._nodes)
        return Lengths(np.ones_like(cells.r), np.ones((M, Q)), np.zeros(M, np.int32))


class LineLengths(Segments):
    """z: L = a log(1 / clip(|g|, g_def, g_max)), g the slope of the nearest extracted line (3.11)."""

    scale_name = "a"

    def _scale(self, config: GroundConfig) -> float:
        return config.length_factor

    def _lengths(self, cells: Cells) -> Lengths:
        c = self.config
        rules = as_array(
            LineRules(c.line_join, c.line_turn, c.slope_max, c.line_rmse, c.line_small, c.line_intercept)
        )
        at, at_nodes, lines = segment_slopes(cells.r, cells.y, cells.use, self._nodes, rules, c.slope_default)
        low, high = c.slope_default, c.slope_clip
        return Lengths(-np.log(np.clip(at, low, high)), -np.log(np.clip(at_nodes, low, high)), lines)
