"""What every ground method is: a regression of heights over the expected ground h0.

The robust frame around it (`segment`) finds h0, seeds and labels; a regression grows from the seeds
and gives a height with a deviation at the nodes of the polar grid, whatever its kernel.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

from datmo.arrays import F64, I32, Bool


@dataclass(frozen=True)
class Cells:
    """One height a cell of the polar grid, (M, N) arrays; values mean nothing where not `use`.

    Attributes:
        r: range [m]. y: height over h0 [m]. use: which cells count. azimuth: in segments, None: all in the
        middle of theirs. noise: variance of y's error [m²], None: not known.
    """

    r: F64
    y: F64
    use: Bool
    azimuth: F64 | None = None
    noise: F64 | None = None

    def narrow(self, use: Bool) -> Cells:
        """The same with only `use` (M, N) counting."""
        return replace(self, use=use)


@dataclass(frozen=True)
class Heights:
    """What a regression says at the nodes of the grid, (M, Q) arrays.

    Attributes:
        mean: latent height over h0 [m]. var: its variance [m²]. noise: variance of an observation
        about it [m²]; `var + noise` is that of a measured height.
    """

    mean: F64
    var: F64
    noise: F64


@dataclass(frozen=True)
class Learned:
    """What a frame taught, for the reader and for the next frame to start from.

    Attributes:
        hyper: hyper-parameters by their name in method.md, SI units.
        candidates: (M,) n_PG, cells of each segment that were regressed. supports: (M,) n_L,
        pseudo-inputs of each segment. lines: (M,) lines of each segment. 0 where a method has none.
        value: the objective reached. evaluations: how often it was taken.
        notes: what the reader should know, such as a bound that was hit.
        frames: how many frames were learned from.
        carried: (M, Q) arrays at the nodes that the next frame starts from, the method's own.
    """

    hyper: dict[str, float]
    candidates: I32
    supports: I32
    lines: I32
    value: float = float("nan")
    evaluations: int = 0
    notes: tuple[str, ...] = ()
    frames: int = 0
    carried: tuple[F64, ...] = ()


class Regression(ABC):
    """A ground method. It holds its grid and settings, nothing of a frame: what one frame leaves to
    the next is the `Learned` that `fit` returns and that the caller passes in again."""

    @abstractmethod
    def start(self) -> Learned:
        """What is known before the first frame of a sequence."""

    @abstractmethod
    def grow(self, cells: Cells, seed: Bool, doubtful: Bool, learned: Learned) -> tuple[Bool, Heights]:
        """Robust growth (Alg. 2, 3.41): which candidates are ground (M, N), and the heights that
        they give.

        Args:
            cells: the lowest point of each cell. seed: (M, N) where the growth starts.
            doubtful: (M, N) candidates of cells that reach far up; they pull little.
            learned: of the frame before, or `start`.
        """

    @abstractmethod
    def fit(self, cells: Cells, learned: Learned) -> tuple[Heights, Learned]:
        """Heights through the ground of each cell, inliers all, with what is learned from them.

        Args:
            cells: the mean of each cell's ground points. learned: of the frame before, or `start`.
        """
