"""The methods zl and zli: length-scales, and noise, that are themselves Gaussian processes (3.20, App. E)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from datmo.arrays import F64, I32
from datmo.ground.config import GroundConfig
from datmo.ground.fields import Field, Latent, Shifted, Supports, along
from datmo.ground.frame import NOISE_BOUND, FrameObjective, climb
from datmo.ground.grid import PolarGrid
from datmo.ground.latent import OBJECTIVES
from datmo.ground.lengths import log_lengths
from datmo.ground.process import Scales, Segments
from datmo.ground.regression import Cells, Learned
from datmo.ground.selection import pack, pseudo_inputs

LENGTH_BOUND = (0.3, 100.0)
FACTOR_BOUND, FACTOR_START = (0.02, 4.0), 0.5
LATENT_START = {"f": 0.5, "l": 10.0, "n": 0.1}


class LatentLengths(Segments):
    """zl: log L = μ + a latent process, μ the log length of the line; all segments learn at once.

    μ holds a factor a on the line length that is learned like the others (a = 1 in the thesis): rough
    ground bends within its lines, and the latent process would have to shift all of them.
    A frame after the first starts from the hyper-parameters and the latent process of the last one.
    """

    latent_noise = False

    def __init__(self, grid: PolarGrid, config: GroundConfig) -> None:
        super().__init__(grid, config)
        self._mode = (OBJECTIVES[config.objective], config.truncated)
        self._factor_bound = FACTOR_BOUND if config.line_factor else (1.0, 1.0)
        self._suffixes = ("", "_noise") if self.latent_noise else ("",)

    def start(self) -> Learned:
        """See `Regression`."""
        c, none = self.config, np.zeros(0, np.int32)
        factor = float(np.clip(FACTOR_START, *self._factor_bound))
        hyper = {"sigma_f": c.signal_std, "a": factor, "sigma_n": c.noise_std}
        hyper |= {f"bar_sigma_{k}{s}": v for s in self._suffixes for k, v in LATENT_START.items()}
        nothing = np.zeros((self.grid.segments, len(self.nodes)))
        return Learned(hyper, none, none, none, carried=(nothing,) * len(self._suffixes))

    def _means(self, cells: Cells) -> tuple[F64, F64, I32]:
        rules, length = self.line_rules, self.config.length
        return log_lengths(cells.r, cells.y, cells.use, self.nodes, rules, length)

    def scales(self, cells: Cells, learned: Learned) -> Scales:
        """See `Segments`; the latent processes are those carried from the last frame."""
        at = [along(self.nodes, field, cells.r) for field in learned.carried]
        return self._scales(self._means(cells), at, learned)

    def _scales(self, means: tuple[F64, F64, I32], at: list[F64], learned: Learned) -> Scales:
        """Scales from μ and the latent processes at the cells and (carried) at the nodes."""
        L, L_nodes = (
            np.exp(np.clip(m + d + np.log(learned.hyper["a"]), *np.log(LENGTH_BOUND)))
            for m, d in ((means[0], at[0]), (means[1], learned.carried[0]))
        )
        floor2 = self.config.noise_floor**2
        n2 = max(learned.hyper["sigma_n"] ** 2 - floor2, NOISE_BOUND[0] ** 2)
        if self.latent_noise:
            noise, noise_nodes = n2 * np.exp(2 * at[1]), n2 * np.exp(2 * learned.carried[1])
        else:
            noise, noise_nodes = np.full(L.shape, n2), np.full(L_nodes.shape, n2)
        return Scales(L, L_nodes, noise + floor2, noise_nodes + floor2, learned.hyper["sigma_f"])

    def objective(self, cells: Cells, means: F64) -> tuple[FrameObjective, list[Latent], Supports]:
        """𝓛 of the frame, its latent fields and their pseudo-inputs; means (M, N)."""
        config = self.config
        packed = pack(cells, np.arange(len(cells.r)), config.learn_cells)
        supports = pseudo_inputs(cells, config.start_height, config.support_angle, config.supports)
        base = np.take_along_axis(means, packed.bin, 1)
        length = Latent("", base, packed, supports, self._mode, ("a", self._factor_bound))
        level = np.zeros(packed.r.shape)
        noise: Field = Shifted("sigma_n", level, NOISE_BOUND)
        latents = [length]
        if self.latent_noise:
            noise = Latent("_noise", level, packed, supports, self._mode, ("sigma_n", NOISE_BOUND))
            latents.append(noise)
        return FrameObjective(packed, length, noise, config.noise_floor), latents, supports

    def learn(self, cells: Cells, learned: Learned) -> tuple[Scales, Learned]:
        """See `Segments`. Without data the last values stay."""
        means, config = self._means(cells), self.config
        objective, latents, supports = self.objective(cells, means[0])
        n_PG, n_L = cells.use.sum(1).astype(np.int32), supports.count.astype(np.int32)
        learned = replace(learned, candidates=n_PG, supports=n_L, lines=means[2])
        if objective.cells.count.any():
            pairs = zip(latents, learned.carried, strict=True)
            own = [latent.own_start(field, self.nodes, learned.hyper) for latent, field in pairs]
            steps = config.learn_next if learned.frames else config.learn_first
            found = climb(objective, objective.theta(learned.hyper, own), steps)
            objective.settle(found.theta)
            learned = replace(
                learned,
                hyper=objective.hyper(found.theta),
                value=found.value,
                evaluations=found.evaluations,
                notes=found.notes,
                frames=learned.frames + 1,
                carried=tuple(latent.at(np.tile(self.nodes, (len(cells.r), 1))) for latent in latents),
            )
            return self._scales(means, [latent.at(cells.r) for latent in latents], learned), learned
        return self._scales(means, [along(self.nodes, f, cells.r) for f in learned.carried], learned), learned


class LatentLengthsAndNoise(LatentLengths):
    """zli (App. E): log n too is a level plus a latent process, with its own pseudo-inputs."""

    latent_noise = True
