"""The methods z and z-se: a shape of the length-scales is given, its scale is learned."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace

import numpy as np

from datmo.arrays import F64, I32
from datmo.ground.config import GroundConfig
from datmo.ground.fields import Shifted
from datmo.ground.frame import NOISE_BOUND, FrameObjective, climb
from datmo.ground.grid import PolarGrid
from datmo.ground.lines import segment_slopes
from datmo.ground.process import Scales, Segments
from datmo.ground.regression import Cells, Learned
from datmo.ground.selection import fullest, pack

SCALE_RANGE = 4.0


class Shaped(Segments):
    """L = scale x shape. Learns scale, σ_f and σ_n from the fullest segments of a frame."""

    name: str
    scale: float

    @abstractmethod
    def shape(self, cells: Cells) -> tuple[F64, F64, I32]:
        """Shape of the length-scales at the cells (M, N) and nodes (M, Q); lines (M,)."""

    def start(self) -> Learned:
        """See `Regression`."""
        c, none = self.config, np.zeros(0, np.int32)
        hyper = {"sigma_f": c.signal_std, self.name: self.scale, "sigma_n": c.noise_std}
        return Learned(hyper, none, none, none)

    def scales(self, cells: Cells, learned: Learned) -> Scales:
        """See `Segments`."""
        return self._scales(self.shape(cells), learned)

    def _scales(self, shape: tuple[F64, F64, I32], learned: Learned) -> Scales:
        at, at_nodes, _ = shape
        scale, sn2 = learned.hyper[self.name], learned.hyper["sigma_n"] ** 2
        noise, noise_nodes = np.full(at.shape, sn2), np.full(at_nodes.shape, sn2)
        return Scales(scale * at, scale * at_nodes, noise, noise_nodes, learned.hyper["sigma_f"])

    def objective(self, cells: Cells, shape: F64) -> FrameObjective:
        """𝓛 in log σ_f, log scale, log n, with σ_n² = floor² + n²; shape (M, N)."""
        rows = fullest(cells, self.config.learn_segments)
        packed = pack(cells, rows, self.config.learn_cells)
        bound = self.scale / SCALE_RANGE, self.scale * SCALE_RANGE
        length = Shifted(self.name, np.log(shape[rows[:, None], packed.bin]), bound)
        noise = Shifted("sigma_n", np.zeros(packed.r.shape), NOISE_BOUND)
        return FrameObjective(packed, length, noise, self.config.noise_floor)

    def learn(self, cells: Cells, learned: Learned) -> tuple[Scales, Learned]:
        """See `Segments`. Without data the last values stay."""
        shape, config = self.shape(cells), self.config
        objective = self.objective(cells, shape[0])
        count = cells.use.sum(1).astype(np.int32)
        learned = replace(learned, candidates=count, supports=np.zeros_like(count), lines=shape[2])
        if len(objective.cells.r):
            steps = config.learn_next if learned.frames else config.learn_first
            found = climb(objective, objective.theta(learned.hyper), steps)
            learned = replace(
                learned,
                hyper=objective.hyper(found.theta),
                value=found.value,
                evaluations=found.evaluations,
                notes=found.notes,
                frames=learned.frames + 1,
            )
        return self._scales(shape, learned), learned


class OneLength(Shaped):
    """z-se, the stationary squared exponential (3.9): L = ℓ everywhere."""

    name = "length"

    def __init__(self, grid: PolarGrid, config: GroundConfig) -> None:
        super().__init__(grid, config)
        self.scale = config.length

    def shape(self, cells: Cells) -> tuple[F64, F64, I32]:
        """See `Shaped`."""
        M = len(cells.r)
        return np.ones(cells.r.shape), np.ones((M, len(self.nodes))), np.zeros(M, np.int32)


class LineLengths(Shaped):
    """z: L = a log(1 / clip(|g|, g_def, g_max)), g the slope of the nearest extracted line (3.11)."""

    name = "a"

    def __init__(self, grid: PolarGrid, config: GroundConfig) -> None:
        super().__init__(grid, config)
        self.scale = config.length_factor

    def shape(self, cells: Cells) -> tuple[F64, F64, I32]:
        """See `Shaped`."""
        low, high = self.config.slope_default, self.config.slope_clip
        at, at_nodes, lines = segment_slopes(
            cells.r, cells.y, cells.use, self.nodes, self.line_rules, low, self.config.lines
        )
        return -np.log(np.clip(at, low, high)), -np.log(np.clip(at_nodes, low, high)), lines
