"""Whole boxes from seen ones: what a road user hides of itself is given the size that its kind has.

From one place a box shows two sides at most, often one: the rear of a car is 1.8 m of width and no length.
Every kind of road user, lying along either side of the rectangle, is weighed by how well the seen extents
suit its sizes: an end that faces the sensor is where it seems, one that faces away may lie farther out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, U8, Bool
from datmo.boxes.config import CompleteConfig, SizePrior
from datmo.messages import Kind

HALF_WIDTH = 0.25  # a uniform of width w has the variance w²/12; between that and an end known exactly


@dataclass(frozen=True)
class Whole:
    """The completed rectangles, row = cluster.

    Attributes:
        extent: (k, 4) x0, x1, y0, y1 along the axes of the seen rectangle [m]. kind: (k,) `Kind`.
        var: (k, 2) of the centre along x and y [m²]. turn: (k,) probability that the length lies along
        the other axis.
    """

    extent: F64
    kind: U8
    var: F64
    turn: F64

    @property
    def size(self) -> F64:
        """(k, 2) along x and y [m]."""
        return np.asarray(self.extent[:, 1::2] - self.extent[:, ::2])

    @property
    def turned(self) -> Bool:
        """(k,) whether the length lies along y."""
        return np.asarray(self.size[:, 1] > self.size[:, 0])


def complete(extent: F64, height: F64, sensor: F64, config: CompleteConfig) -> Whole:
    """The most likely whole rectangle of each cluster.

    Args:
        extent: (k, 4) x0, x1, y0, y1 of the seen rectangle along its axes [m]. height: (k,) [m].
        sensor: (k, 2) where the sensor is along the same axes [m].
    """
    extent, k, priors = np.asarray(extent, float), len(extent), config.kinds
    seen = extent[:, 1::2] - extent[:, ::2]
    bounded = _bounded(extent, sensor, config.grazing)
    # The last hypothesis is that no kind suits: nothing is cut, nothing is added.
    score = np.full((len(priors) + 1, 2, k), config.unknown)
    cut = np.zeros((len(priors) + 1, 2, k, 2), bool)
    for i, prior in enumerate(priors):
        tall = _normal(height, prior.height) + np.log(prior.share)
        for j, sizes in enumerate(((prior.length, prior.width), (prior.width, prior.length))):
            fits, cut[i, j] = _suits(seen, bounded, sizes, config.cut)
            score[i, j] = fits + tall
    kind, along = np.divmod(score.reshape(2 * len(score), k).argmax(0), 2)
    known, rows = kind < len(priors), np.arange(k)
    odds = np.exp(np.clip(score[kind, 1 - along, rows] - score[kind, along, rows], -50, 0))
    mean, std = _sizes(priors, kind, along)
    grown, var = _grow(extent, sensor, cut[kind, along, rows], mean, std, config)
    names = np.array([*(prior.kind for prior in priors), Kind.UNKNOWN], np.uint8)
    var = np.where(known[:, None], var, seen**2 / 12 + config.place**2)
    return Whole(grown, names[kind], var, np.where(known, odds / (1 + odds), 0.0))


def _bounded(extent: F64, sensor: F64, grazing: float) -> Bool:
    """(k, 2) whether both ends along each axis show: the side that runs along it is seen, not grazed."""
    outside = np.maximum(np.maximum(extent[:, ::2] - sensor, sensor - extent[:, 1::2]), 0)
    away = np.hypot(*((extent[:, ::2] + extent[:, 1::2]) / 2 - sensor).T)
    return np.asarray(outside[:, ::-1] > grazing * away[:, None])


def _normal(value: F64, prior: tuple[float, float]) -> F64:
    """Log density (k,) of the normal distribution of a size (mean, std)."""
    return np.asarray(-0.5 * ((value - prior[0]) / prior[1]) ** 2 - np.log(prior[1] * np.sqrt(2 * np.pi)))


def _part(value: F64, prior: tuple[float, float]) -> F64:
    """Log density (k,) of any part of a size: level up to its mean, then falling."""
    return np.asarray(
        -0.5 * (np.maximum(value - prior[0], 0) / prior[1]) ** 2
        - np.log(prior[0] + prior[1] * np.sqrt(np.pi / 2))
    )


def _suits(
    seen: F64, bounded: Bool, sizes: tuple[tuple[float, float], ...], price: float
) -> tuple[F64, Bool]:
    """Log likelihood (k,) of the seen extents (k, 2) for a kind's sizes along them, and whether each is cut.

    A whole extent scatters about the kind's; a cut one may be any part of it. That a bounded one is cut
    after all, by an occluder, has its price.
    """
    whole = np.stack([_normal(seen[:, a], sizes[a]) for a in range(2)], 1)
    part = np.stack([_part(seen[:, a], sizes[a]) for a in range(2)], 1) - np.where(bounded, price, 0.0)
    return np.maximum(whole, part).sum(1), np.asarray(part > whole)


def _sizes(priors: tuple[SizePrior, ...], kind: F64, along: F64) -> tuple[F64, F64]:
    """Mean and std (k, 2) of the chosen kind's size along x and y [m]; mean 0 of none."""
    none = ((0.0, 1.0), (0.0, 1.0))
    table = np.array([*((prior.length, prior.width) for prior in priors), none])[kind]  # (k, side, mean|std)
    table = np.where((along == 1)[:, None, None], table[:, ::-1], table)
    return table[..., 0], table[..., 1]


def _grow(
    extent: F64, sensor: F64, cut: Bool, mean: F64, std: F64, config: CompleteConfig
) -> tuple[F64, F64]:
    """Extents (k, 4) with the far ends moved out, and the variance (k, 2) of their middles."""
    seen, middle = extent[:, 1::2] - extent[:, ::2], (extent[:, 1::2] + extent[:, ::2]) / 2
    gain = np.where(cut, 1.0, config.edge**2 / (config.edge**2 + std**2))
    more = gain * np.maximum(mean - seen, 0)
    far = np.where(sensor > middle, -1.0, 1.0)
    grown = extent.copy()
    grown[:, ::2] -= np.where(far < 0, more, 0)
    grown[:, 1::2] += np.where(far > 0, more, 0)
    return grown, np.where(cut, std**2 / 4 + (HALF_WIDTH * more) ** 2, config.edge**2 / 4) + config.place**2
