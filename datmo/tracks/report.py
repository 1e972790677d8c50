"""From the tracker's own arrays to messages."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, U8, Array
from datmo.geometry import axes_of, half_turn
from datmo.messages import Boxes, Tracks
from datmo.tracks.bank import Bank
from datmo.tracks.config import TrackerConfig
from datmo.tracks.management.birth import Newborns
from datmo.tracks.models import velocity


def predicted_boxes(bank: Bank, mean: F64) -> Boxes:
    """Boxes (t) of the bank at the combined mean (t, n), heading along the motion."""
    return Boxes(**_predicted(bank, mean))


def _predicted(bank: Bank, mean: F64) -> dict[str, Array]:
    heading = mean[:, 2]
    yaw = heading + half_turn(bank.yaw - heading)
    return {
        "center": np.column_stack([mean[:, :2], bank.z]),
        "size": bank.size,
        "yaw": np.arctan2(np.sin(yaw), np.cos(yaw)),
        "velocity": velocity(mean),
        "score": bank.score,
        "id": bank.id,
        "kind": bank.kind,
    }


def lasting(bank: Bank, config: TrackerConfig) -> F64:
    """Covariance (t, 2, 2) [m²] of what every box of a track is off by alike, which no filter can tell.

    Larger along a side of which an end was never seen, as then its length is a guess.
    """
    std = config.bias_std + np.where(bank.known, 0.0, config.unknown_side_std * bank.size[:, :2])
    axes = axes_of(bank.yaw)
    return np.asarray(np.einsum("ta,tai,taj->tij", std**2, axes, axes))


def as_tracks(
    bank: Bank, mean: F64, P: F64, status: U8, new: Newborns, stamp: float, config: TrackerConfig
) -> Tracks:
    """Confirmed tracks and new ones, by id."""
    x, cov, _ = new.polar(config)
    young = {
        "center": np.column_stack([x[:, :2], new.z]),
        "size": new.size,
        "yaw": x[:, 2],
        "velocity": new.x[:, 2:],
        "score": new.score,
        "id": new.id,
        "kind": new.kind,
    }
    order = np.argsort(np.concatenate([bank.id, new.id]), kind="stable")
    both = {name: np.concatenate([old, young[name]])[order] for name, old in _predicted(bank, mean).items()}
    P = P.copy()
    P[:, :2, :2] += lasting(bank, config)
    modes = bank.mu.shape[1]
    return Tracks(
        boxes=Boxes(**both),
        stamp=stamp,
        cov=np.concatenate([P[:, :5, :5], cov])[order],
        mode_prob=np.concatenate([bank.mu, np.full((len(new), modes), 1 / modes)])[order],
        status=np.concatenate([status, np.minimum(new.hits, 4).astype(np.uint8)])[order],
        is_dynamic=np.concatenate([bank.dynamic, np.zeros(len(new), np.bool_)])[order],
    )
