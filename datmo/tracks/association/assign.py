"""One scan's association: candidate pairs, gate, weights, exact marginals."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64
from datmo.messages import Sight
from datmo.tracks.association.associate import associate
from datmo.tracks.association.existence import given_existence
from datmo.tracks.association.gate import (
    densities,
    gate,
    near,
    size_ratios,
    squared_distance,
    sure_yaw,
    yaw_ratios,
)
from datmo.tracks.association.pda import Links
from datmo.tracks.bank import Bank
from datmo.tracks.config import TrackerConfig
from datmo.tracks.measurement.box import read
from datmo.tracks.measurement.measured import Measured
from datmo.tracks.measurement.pairs import Pairs

LEAST_WEIGHT = 1e-200


def assign(
    bank: Bank,
    mean: F64,
    P: F64,
    given: Measured,
    visible: F64,
    sight: Sight | None,
    config: TrackerConfig,
) -> tuple[Pairs, Links, F64]:
    """Gated pairs, their probabilities, and each pair's mode likelihood over their mean (p, m).

    P_D is that of full view times the share `visible` (t,), with a floor. Probabilities are those of
    tracks that exist; `bank.existence` is brought up to date.
    """
    reach = bank.size[:, 0] / 2 if sight is not None else np.zeros(len(bank))
    pairs = read(bank, mean, given, *near(mean, P, given.boxes.center, reach, config), sight, config)
    pairs = gate(pairs, mean, P, config)
    pairs.yaw = sure_yaw(pairs, mean, P, config)
    by_mode, shape = densities(pairs, bank.x, bank.P), np.ones(len(pairs))
    if config.weigh_shape:
        by_mode = by_mode * yaw_ratios(pairs, bank.x, bank.P)
        shape = size_ratios(pairs, bank.size)
    density = np.einsum("pm,pm->p", by_mode, bank.mu[pairs.track])
    detection = config.detection_prob * np.maximum(visible, config.visible_floor)
    found = detection * config.gate_prob
    miss = 1 - bank.existence * found
    weight = np.maximum((bank.existence * detection)[pairs.track] * density * shape, LEAST_WEIGHT)
    S = P[:, :2, :2] + config.position_std**2 * np.eye(2)
    links = associate(pairs, weight, miss, len(given), config, S, mean[:, :2])
    links, bank.existence = given_existence(links, pairs.track, bank.existence, found)
    return pairs, links, by_mode / np.maximum(density, LEAST_WEIGHT)[:, None]


def likeliest(pairs: Pairs, links: Links, least: float) -> Pairs:
    """For each track its likeliest pair, where that is at least `least` probable."""
    order = np.lexsort((-links.beta, pairs.track))
    first = np.ones(len(order), np.bool_)
    first[1:] = np.diff(pairs.track[order]) > 0
    rows = order[first]
    return pairs.select(rows[links.beta[rows] >= least])


def innovations(bank: Bank, mean: F64, P: F64, best: Pairs) -> dict[int, tuple[float, int]]:
    """Normalised innovation squared of the likeliest box of each track, by id, and its dimension."""
    S = P[best.track][:, :2, :2] + best.R
    nu = best.z - mean[best.track, :2]
    nis = squared_distance(nu, S)
    return {int(i): (float(v), 2) for i, v in zip(bank.id[best.track], nis, strict=True)}
