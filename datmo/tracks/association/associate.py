"""From gated pairs to association probabilities, by the method that the configuration names.

"jpda" and "jipda": independent groups, each summed exactly; they differ in the weights that they are
given (`existence.py`). "pda": each track by itself. "gnn": the one best joint event.
"""

from __future__ import annotations

from math import lgamma

import numpy as np
from numba import njit

from datmo.arrays import F64, I64
from datmo.tracks.association.jpda import marginals
from datmo.tracks.association.nearest import nearest
from datmo.tracks.association.pda import Links, pda, unassigned
from datmo.tracks.config import TrackerConfig
from datmo.tracks.measurement.pairs import Pairs
from datmo.union_find import join

RASTER = 160  # cells a side for the area of several gates together


def associate(
    pairs: Pairs, weight: F64, miss: F64, boxes: int, config: TrackerConfig, S: F64, at: F64
) -> Links:
    """Association probabilities; those of "jpda" are exact marginals (2.69 with 1 - P_D P_G).

    Args:
        pairs: gated pairs.
        weight: (p,) P_D N(nu) [1/m²] times what size and heading say.
        miss: (t,) 1 - P_D P_G.
        boxes: number of boxes.
        config: method, form and density of the clutter.
        S: (t, 2, 2), at: (t, 2) gates, for their area in the non-parametric form.
    """
    if config.clutter == "poisson":
        weight = weight / config.clutter_density
    if config.association == "pda":
        return Links(*pda(pairs, weight, unassigned(pairs, miss, config)), 0)
    if config.association == "gnn":
        return Links(*nearest(pairs, weight, unassigned(pairs, miss, config), boxes), 0)
    return _jointly(pairs, weight, miss, boxes, config, S, at)


def _jointly(
    pairs: Pairs, weight: F64, miss: F64, boxes: int, config: TrackerConfig, S: F64, at: F64
) -> Links:
    """Marginals of the joint events of each group of tracks; closed form for tracks alone."""
    beta, cut = np.zeros(len(pairs)), 0
    alone, crowds = groups(pairs, len(miss), boxes)
    lone = pairs.select(alone)
    beta[alone], missed = pda(lone, weight[alone], unassigned(lone, miss, config))
    for rows in crowds:
        track, local = np.unique(pairs.track[rows], return_inverse=True)
        box, column = np.unique(pairs.box[rows], return_inverse=True)
        W = np.zeros((len(track), len(box)))
        W[local, column] = weight[rows]
        phi = None
        if config.clutter == "nonparametric":
            phi = clutter_weights(len(box), min(W.shape), union_area(S[track], at[track], config))
        out, dropped = marginals(W, miss[track], phi, config.max_frontier)
        beta[rows], missed[track], cut = out[local, column], out[:, -1], cut + dropped
    return Links(beta, missed, cut)


def groups(pairs: Pairs, tracks: int, boxes: int) -> tuple[I64, list[I64]]:
    """Rows of the pairs of tracks that share no box; and of each set of tracks that share boxes,
    directly or through others.
    """
    label, size = _labels(pairs.track, pairs.box, tracks, boxes)
    crowded = size[label] > 1
    rows = np.flatnonzero(crowded)
    if len(rows) == 0:
        return np.arange(len(pairs)), []
    order = rows[np.argsort(label[rows], kind="stable")]
    split = np.split(order, np.flatnonzero(np.diff(label[order])) + 1)
    return np.flatnonzero(~crowded), list(split)


@njit(cache=True, nogil=True)
def _labels(track: I64, box: I64, tracks: int, boxes: int) -> tuple[I64, I64]:  # pragma: no cover - compiled
    """Of each pair a label of its group, and by label the number of tracks in it."""
    parent = np.arange(tracks + boxes)
    for p in range(len(track)):
        join(parent, track[p], tracks + box[p])
    size = np.zeros(tracks + boxes, np.int64)
    for k in range(tracks + boxes):
        parent[k] = parent[parent[k]]
        size[parent[k]] += k < tracks
    return parent[track], size


def clutter_weights(boxes: int, most: int, volume: float) -> F64:
    """phi! / V^phi by the number of boxes assigned, 0 .. most, scaled to a largest of one."""
    phi = boxes - np.arange(most + 1)
    log = np.array([lgamma(n + 1) for n in phi]) - phi * np.log(volume)
    return np.asarray(np.exp(log - log.max()))


def union_area(S: F64, at: F64, config: TrackerConfig) -> float:
    """Area [m²] of the union of the gates (k), counted on a raster."""
    half = np.sqrt(config.gate_chi2 * np.einsum("kii->ki", S))
    low, high = (at - half).min(0), (at + half).max(0)
    x, y = (low[i] + (np.arange(RASTER) + 0.5) / RASTER * (high[i] - low[i]) for i in range(2))
    inside = np.zeros((RASTER, RASTER), np.bool_)
    for center, inverse in zip(at, np.linalg.inv(S), strict=True):
        dx, dy = x[:, None] - center[0], y[None] - center[1]
        d = inverse[0, 0] * dx**2 + 2 * inverse[0, 1] * dx * dy + inverse[1, 1] * dy**2
        inside |= d <= config.gate_chi2
    return float(inside.mean() * np.prod(high - low))
