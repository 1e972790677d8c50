"""Track management in time: Table 4.1, deaths, duplicates, static or dynamic (Alg. 3-4)."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, U8, Bool
from datmo.messages import Status
from datmo.tracks.association import existence
from datmo.tracks.bank import Bank
from datmo.tracks.config import TrackerConfig

DRIFTS = int(Status.LAST) - int(Status.DRIFTING) + 1
BREAK = 0.35  # [s] hits so far apart do not follow each other closely
TOGETHER = 3  # scans for which two tracks must be near before they are one
HIDDEN_SHARE = 0.2  # below this share in view a miss is no evidence at all


def spent(bank: Bank, stamp: float, dt: float, has_sight: bool, config: TrackerConfig) -> F64:
    """Share (t,) of its life without hits that each track has used up; from 1 on it is dead."""
    if config.association == "jipda":
        return existence.spent(bank, config)
    if not has_sight:
        return np.asarray((stamp - bank.seen) / max(config.max_coast, 1.5 * dt))
    return np.asarray(np.maximum(bank.missed / config.max_missed, (stamp - bank.seen) / config.max_hidden))


def status(share: F64) -> U8:
    """Table 4.1 with drifting as spans of time: 5 hit, 6-10 by the share of life spent."""
    drift = int(Status.DRIFTING) + np.floor(np.clip(share + 1e-9, 0, 0.999) * DRIFTS)
    return np.where(share <= 0, int(Status.TRACKING), drift).astype(np.uint8)


def charge(bank: Bank, hit: Bool, visible: F64, empty: F64, dt: float, config: TrackerConfig) -> None:
    """Add the time of a miss to each track's account, as far as it should have been seen.

    Where rays pass through the place it counts more. A hit settles the account.
    """
    share = np.where(visible < HIDDEN_SHARE, 0.0, visible)
    more = config.empty_weight * np.where(share > 0, empty, 0.0)
    bank.missed = np.where(hit, 0.0, bank.missed + dt * (share + more))


def alive(mean: F64, P: F64, share: F64, config: TrackerConfig) -> Bool:
    """(t,) tracks to keep: life left, finite, and not lost in their own uncertainty."""
    std = np.sqrt(np.maximum(P[:, 0, 0], P[:, 1, 1]))
    finite = np.isfinite(mean).all(axis=1) & np.isfinite(P).all(axis=(1, 2))
    return np.asarray((share < 1 - 1e-9) & finite & (std <= config.max_position_std))


def duplicates(bank: Bank, mean: F64, config: TrackerConfig) -> Bool:
    """(t,) tracks that repeat an older one; the younger dies.

    They have been nearer than `duplicate_distance` for some scans: two that pass each other are so
    near for less. Or one lies inside the other's box and their difference has kept still: two cars
    parked side by side keep still too, but apart.
    """
    gap = mean[:, None, :2] - mean[None, :, :2]
    distance = np.linalg.norm(gap, axis=2)
    inside = distance < np.minimum(bank.size[:, None, 1], bank.size[None, :, 1]) / 2 + 0.3
    dead = np.zeros(len(bank), np.bool_)
    for i, j in zip(*np.nonzero(np.triu((distance < config.duplicate_distance) | inside, 1)), strict=True):
        limit = min(config.duplicate_distance, 0.8 * min(bank.size[i, 0], bank.size[j, 0]))
        if _apart(bank, i, j) < limit or _still(bank, i, j) < config.duplicate_spread:
            dead[j if (bank.born[i], bank.id[i]) <= (bank.born[j], bank.id[j]) else i] = True
    return dead


def judge_motion(bank: Bank, mean: F64, P: F64, hit: Bool, stamp: float, config: TrackerConfig) -> None:
    """Static or dynamic (Alg. 4) from the last `window` seconds; the undecided keep their label.

    A track younger than that, or seen again for less, may already be called dynamic, by a displacement
    beyond its doubt.
    """
    recent = bank.past[:, :, 0] >= stamp - config.window - 1e-6
    judged = hit & (recent.sum(axis=1) >= 3)
    enough = judged & (stamp - bank.steady >= config.window)
    count = np.maximum(recent.sum(axis=1), 1)
    speed = np.where(recent, np.abs(bank.past[:, :, 3]), 0).sum(axis=1) / count
    first = np.argmax(recent, axis=1)
    start = bank.past[np.arange(len(bank)), first]
    moved = mean[:, :2] - start[:, 1:3]
    span = np.maximum(stamp - start[:, 0], 1e-3)
    sure = 3 * np.sqrt(P[:, 0, 0] + P[:, 1, 1]) + 0.2
    displacement = np.linalg.norm(moved, axis=1)
    static = (speed < config.static_speed) & (displacement <= sure)
    left = judged & (displacement / span >= config.static_speed) & (displacement > sure)
    dynamic = left | enough & (speed >= 2 * config.static_speed)
    bank.dynamic = np.where(enough & static, False, np.where(dynamic, True, bank.dynamic))


def _apart(bank: Bank, i: int, j: int) -> float:
    """Largest distance [m] of two tracks over the last scans; infinite when too short."""
    gap = np.linalg.norm(bank.past[i, -TOGETHER:, 1:3] - bank.past[j, -TOGETHER:, 1:3], axis=1)
    return float(gap.max()) if np.isfinite(gap).all() else np.inf


def _still(bank: Bank, i: int, j: int) -> float:
    """Summed standard deviation [m] of the difference of two pasts; infinite when too short."""
    both = np.isfinite(bank.past[i, :, 0]) & np.isfinite(bank.past[j, :, 0])
    if both.sum() < 5:
        return np.inf
    return float(np.std(bank.past[i, both, 1:3] - bank.past[j, both, 1:3], axis=0).sum())
