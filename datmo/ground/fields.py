"""The logarithm of the length-scales or of the noise of all cells, as a function of parameters.

Every method is two such fields, one for log L and one for log n, in one objective (`frame`): z shifts a
shape, zl adds a latent process to the log line length, zli another to the log noise.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numba
import numpy as np

from datmo.arrays import F64, I64
from datmo.ground import latent
from datmo.threads import over_rows

Bound = tuple[float, float]
LATENT_BOUNDS: dict[str, Bound] = {"f": (0.02, 3.0), "l": (1.0, 200.0), "n": (0.02, 2.0)}
DELTA_BOUND = 5.0


@dataclass(frozen=True)
class Packed:
    """Cells that are learned from, first in each row: r, y (B, K) [m]; count (B,); bin (B, K) of each."""

    r: F64
    y: F64
    count: I64
    bin: I64


@dataclass(frozen=True)
class Supports:
    """Pseudo-inputs r̄ (B, P) [m], the first `count` (B,) of each row hold."""

    r: F64
    count: I64

    @property
    def holds(self) -> F64:
        """(B, P) which entries hold."""
        return np.asarray(np.arange(self.r.shape[1]) < self.count[:, None])


@numba.njit(cache=True, nogil=True)
def along(nodes: F64, table: F64, r: F64) -> F64:
    """Rows of table (B, Q) at the nodes, interpolated at r (B, K)."""
    out = np.empty(r.shape)
    for m in range(len(r)):
        out[m] = np.interp(r[m], nodes, table[m])
    return out


class Field(ABC):
    """log L or log n (B, K) of the packed cells."""

    #: names, starting values and bounds of its shared parameters, all positive, learned as logarithms
    names: tuple[str, ...]
    bounds: tuple[Bound, ...]

    @property
    def free(self) -> int:
        """Number of parameters that are not shared."""
        return 0

    @abstractmethod
    def values(self, shared: F64, own: F64) -> tuple[F64, F64]:
        """Field (B, K) and what the objective charges for it (B,)."""

    @abstractmethod
    def gradient(self, g: F64) -> tuple[F64, F64]:
        """Gradient in the shared parameters and in its own at the last `values`, given that in the
        field, g (B, K)."""


class Shifted(Field):
    """base + log scale: one shared parameter."""

    def __init__(self, name: str, base: F64, bound: Bound) -> None:
        self.names, self.bounds, self._base = (name,), (bound,), base

    def values(self, shared: F64, own: F64) -> tuple[F64, F64]:  # noqa: ARG002
        """See `Field`."""
        return self._base + shared[0], np.zeros(len(self._base))

    def gradient(self, g: F64) -> tuple[F64, F64]:
        """See `Field`."""
        return np.array([g.sum()]), np.zeros(0)


class Latent(Field):
    """base (+ log scale, if `scale` names it) + a latent process with its supports (3.20)."""

    def __init__(
        self,
        suffix: str,
        base: F64,
        cells: Packed,
        supports: Supports,
        mode: tuple[int, bool],
        scale: tuple[str, Bound] | None = None,
    ) -> None:
        names = tuple(f"bar_sigma_{k}{suffix}" for k in LATENT_BOUNDS)
        self.names = ((scale[0],) if scale else ()) + names
        self.bounds = ((scale[1],) if scale else ()) + tuple(LATENT_BOUNDS.values())
        self._base, self._cells, self._supports, self._mode = base, cells, supports, mode
        self._scaled, self._holds = scale is not None, supports.holds
        self._x, self._h = np.zeros(supports.r.shape), np.zeros(supports.r.shape)
        self._hyper = np.zeros(3)

    @property
    def free(self) -> int:
        """Number of supports."""
        return int(self._supports.count.sum())

    def values(self, shared: F64, own: F64) -> tuple[F64, F64]:
        """See `Field`; `own` is u of all supports when whitened, else δ."""
        cells, supports = self._cells, self._supports
        self._hyper = np.exp(shared[-3:])
        self._x[self._holds] = own
        cost = np.zeros(len(cells.r))
        # Both are too short for handing them to threads to pay.
        hyper = self._hyper
        latent.weights(supports.r, supports.count, self._x, self._h, cost, hyper, self._mode[0])
        out = self._base + (shared[0] if self._scaled else 0.0)
        latent.spread(cells.r, cells.count, supports.r, supports.count, self._h, out, hyper)
        return out, cost

    def at(self, r: F64) -> F64:
        """The latent process at r (B, K) [m], without base and scale."""
        out = np.zeros(r.shape)
        every = np.full(len(r), r.shape[1])
        rows = (r, every, self._supports.r, self._supports.count, self._h, out)
        over_rows(latent.spread, rows, (self._hyper,))
        return out

    def gradient(self, g: F64) -> tuple[F64, F64]:
        """See `Field`."""
        cells, supports = self._cells, self._supports
        dx, dhyper = np.zeros(supports.r.shape), np.zeros((len(g), 3))
        rows = (cells.r, cells.count, supports.r, supports.count, self._x, self._h, g, dx, dhyper)
        over_rows(latent.gradients, rows, (self._hyper, *self._mode))
        shift = [g.sum()] if self._scaled else []
        return np.concatenate([shift, dhyper.sum(0)]), dx[self._holds]

    def own_start(self, carried: F64, nodes: F64, hyper: dict[str, float]) -> F64:
        """Its own parameters for values δ at the supports, from those at the nodes (B, Q) [m]."""
        x = np.where(self._holds, along(nodes, carried, self._supports.r), 0.0)
        if self._mode[0] == latent.WHITENED:
            by_name = np.array([hyper[name] for name in self.names[-3:]])
            over_rows(latent.whiten, (self._supports.r, self._supports.count, x), (by_name,))
        return np.asarray(x[self._holds])
