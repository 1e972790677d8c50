"""Probabilistic data association: each track by itself (2.59-2.62; method.md section 12)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.tracks.config import TrackerConfig
from datmo.tracks.measurement.pairs import Pairs


@dataclass
class Links:
    """Marginals: beta (p,) of each pair, missed (t,) of none; and how many links were cut."""

    beta: F64
    missed: F64
    cut: int


def unassigned(pairs: Pairs, miss: F64, config: TrackerConfig) -> F64:
    """Weight (t,) of no box beside those of single pairs, for tracks by themselves.

    That is `miss` (t,), 1 - P_D P_G, in Poisson's form, whose pair weights are over the clutter
    density; in the non-parametric form m_k / V stands where the clutter density does.
    """
    none = miss.copy()
    if config.clutter == "nonparametric":
        count = np.bincount(pairs.track, minlength=len(miss))
        none[pairs.track] *= count[pairs.track] / pairs.volume
    return none


def pda(pairs: Pairs, weight: F64, none: F64) -> tuple[F64, F64]:
    """The closed form: beta (p,) and missed (t,), from weights (p,) and (t,). Boxes may be shared."""
    total = none + np.bincount(pairs.track, weights=weight, minlength=len(none))
    return weight / total[pairs.track], np.asarray(none / total)
