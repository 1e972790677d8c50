"""Joint integrated PDA: tracks that may not exist (Musicki and Evans 2004; Challa et al. 2011).

Each track has a probability r to exist. Joint events weigh a track without a box by 1 - r P_D P_G
and one with a box by r P_D N(nu); what they say of the boxes then also says whether the track is
there. With r = 1, as the other methods have it throughout, all of this changes nothing.
"""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, I64
from datmo.tracks.association.pda import Links
from datmo.tracks.bank import Bank
from datmo.tracks.config import TrackerConfig

LEAST = 1e-6  # a track is never quite impossible: what it does if it exists stays defined


def at_birth(n: int, config: TrackerConfig) -> F64:
    """Existence (n,) of tracks just confirmed."""
    return np.full(n, config.born_existence if config.association == "jipda" else 1.0)


def survive(existence: F64, dt: float, config: TrackerConfig) -> F64:
    """Existence (t,) before a scan, `dt` [s] after the last one: objects leave at a constant rate."""
    if config.association != "jipda":
        return existence
    return np.asarray(np.maximum(existence * np.exp(-dt / config.survival_time), LEAST))


def given_existence(links: Links, track: I64, prior: F64, found: F64) -> tuple[Links, F64]:
    """Links of tracks that exist, and existence after the scan (t,).

    Args:
        links: marginals of the joint events. track: (p,) row of each pair.
        prior: (t,) existence before the scan.
        found: (t,) P_D P_G, the probability to be found where it exists.
    """
    unseen = prior * (1 - found) / (1 - prior * found)  # existence of a track without a box
    existence = 1 - links.missed * (1 - unseen)
    beta, missed = links.beta / existence[track], links.missed * unseen / existence
    return Links(beta, missed, links.cut), existence


def spent(bank: Bank, config: TrackerConfig) -> F64:
    """Share (t,) of its life that each track has used up: 0 when hit, from 1 on it is dead."""
    share = (1 - bank.existence) / (1 - config.dead_existence)
    return np.where(bank.fresh & (share < 1), 0.0, share)
