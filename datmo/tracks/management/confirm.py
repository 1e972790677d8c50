"""From boxes nobody claims to confirmed tracks."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, Bool
from datmo.messages import Boxes
from datmo.tracks.association.existence import at_birth
from datmo.tracks.association.pda import Links
from datmo.tracks.bank import HISTORY, Bank
from datmo.tracks.config import TrackerConfig
from datmo.tracks.management.birth import Newborns
from datmo.tracks.measurement.ends import moved_middle
from datmo.tracks.measurement.pairs import Pairs

NEW_ACCEL_STD = 1.0  # [m/s²] of a track just confirmed


def unclaimed(
    boxes: Boxes, pairs: Pairs, links: Links, bank: Bank, mean: F64, hit: Bool, config: TrackerConfig
) -> Bool:
    """(k,) boxes that may start a track: in no track's hands, and not a splinter inside one."""
    claimed = np.zeros(len(boxes))
    np.add.at(claimed, pairs.box, links.beta * bank.existence[pairs.track])
    gap = boxes.center[:, None, :2] - mean[None, hit, :2]
    c, s = np.cos(bank.yaw[hit]), np.sin(bank.yaw[hit])
    along, across = gap[..., 0] * c + gap[..., 1] * s, gap[..., 1] * c - gap[..., 0] * s
    half = bank.size[hit] / 2
    inside = (np.abs(along) < half[:, 0]) & (np.abs(across) < half[:, 1])
    return np.asarray((claimed < config.claim) & ~inside.any(axis=1))


def as_bank(new: Newborns, stamp: float, size: int, config: TrackerConfig) -> Bank:
    """New tracks as confirmed ones of states of `size`, every mode alike and equally likely."""
    n, m = len(new), len(config.models)
    known, cov, _ = new.polar(config)
    x, P = np.zeros((n, size)), np.tile(NEW_ACCEL_STD**2 * np.eye(size), (n, 1, 1))
    x[:, :5], P[:, :5, :5] = known, cov
    past = np.full((n, HISTORY, 4), np.nan)
    past[:, -1, 0], past[:, -1, 1:] = stamp, x[:, [0, 1, 3]]
    return Bank(
        id=new.id,
        born=new.born,
        seen=np.full(n, stamp),
        steady=new.born,
        fresh=np.ones(n, np.bool_),
        x=np.repeat(x[:, None], m, axis=1),
        P=np.repeat(P[:, None], m, axis=1),
        mu=np.full((n, m), 1 / m),
        missed=np.zeros(n),
        existence=at_birth(n, config),
        known=np.zeros((n, 2), np.bool_),
        held=new.held * np.where(np.cos(x[:, 2] - new.yaw) < 0, -1.0, 1.0)[:, None],
        size=new.size,
        yaw=x[:, 2].copy(),
        z=new.z,
        climb=np.zeros(n),
        score=new.score,
        kind=new.kind,
        dynamic=np.zeros(n, np.bool_),
        backward=np.zeros(n),
        past=past,
    )


def take_over(old: Bank, new: Bank) -> Bank:
    """New tracks under the identity of old ones, row by row: id, age, label and full size."""
    new.id, new.born, new.dynamic = old.id, old.born, old.dynamic
    new.steady, new.known = new.seen, old.known
    size = np.maximum(new.size, old.size)
    new.shift(moved_middle(new.held, (size - new.size)[:, :2], new.yaw))
    new.size = size
    new.past[:, :-1] = old.past[:, 1:]
    return new
