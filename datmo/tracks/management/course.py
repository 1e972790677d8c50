"""Mends the heading of tracks that their motion belies."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, Bool
from datmo.geometry import half_turn, wrap_angle
from datmo.tracks.bank import Bank
from datmo.tracks.models import OMEGA, PSI, V, velocity

COURSE_TIME, COURSE_SPEED = 0.5, 2.0  # [s], [m/s]: who goes so fast for so long shows where to
COURSE_OFF = 0.6  # share of that speed by which the state may differ
COURSE_BEND = 0.4  # share of the way by which its middle may lie off: a leap is no course
COURSE_STD = 0.2  # [rad]
BACKWARD_SPEED, BACKWARD_TIME = 1.0, 1.0  # who reverses faster and longer than this was born turned around


def set_course(bank: Bank, mean: F64, hit: Bool, stamp: float, dt: float) -> None:
    """Mend headings that the motion belies: across it, or the wrong way round."""
    realign(bank, mean, hit, stamp)
    turn_around(bank, mean, dt)


def turn_around(bank: Bank, mean: F64, dt: float) -> None:
    """Turn tracks whose heading was taken the wrong way: (psi + pi, -v) is the same motion."""
    reversing = mean[:, V] < -BACKWARD_SPEED
    bank.backward = np.where(reversing, bank.backward + dt, 0.0)
    rows = np.flatnonzero(bank.backward >= BACKWARD_TIME)
    if len(rows) == 0:
        return
    bank.x[rows, :, PSI] = wrap_angle(bank.x[rows, :, PSI] + np.pi)
    bank.x[rows, :, V] *= -1
    bank.P[rows, :, V, :] *= -1
    bank.P[rows, :, :, V] *= -1
    bank.yaw[rows] = wrap_angle(bank.yaw[rows] + np.pi)
    bank.held[rows] *= -1
    bank.backward[rows] = 0.0


def realign(bank: Bank, mean: F64, hit: Bool, stamp: float) -> None:
    """Point tracks along the way they go, where their state will not have it.

    A track born across its motion follows by the random model alone: it stays on its object, yet
    knows neither heading nor speed. Its own past does.
    """
    recent = bank.past[:, :, 0] >= stamp - COURSE_TIME - 1e-6
    first = np.argmax(recent, axis=1)
    start = bank.past[np.arange(len(bank)), first]
    span = stamp - start[:, 0]
    known = hit & recent.any(axis=1) & (span >= COURSE_TIME / 2) & (recent.sum(axis=1) >= 4)
    way = np.where(known[:, None], (mean[:, :2] - start[:, 1:3]) / np.maximum(span, 1e-3)[:, None], 0.0)
    speed = np.hypot(way[:, 0], way[:, 1])
    halfway = bank.past[np.arange(len(bank)), (first + bank.past.shape[1] - 1) // 2, 1:3]
    bend = np.hypot(*(2 * halfway - start[:, 1:3] - mean[:, :2]).T)
    known &= np.nan_to_num(bend, nan=np.inf) < COURSE_BEND * speed * span
    off = np.hypot(*(velocity(mean) - way).T)
    rows = np.flatnonzero(known & (speed > COURSE_SPEED) & (off > COURSE_OFF * speed))
    course = np.arctan2(way[rows, 1], way[rows, 0])
    bank.x[rows, :, PSI], bank.x[rows, :, V] = course[:, None], speed[rows, None]
    bank.x[rows, :, OMEGA:] = 0.0
    for k, std in ((PSI, COURSE_STD), (V, COURSE_SPEED / 2)):
        bank.P[rows, :, k, :] = bank.P[rows, :, :, k] = 0.0
        bank.P[rows, :, k, k] = std**2
    bank.mu[rows] = 1 / bank.mu.shape[1]
    across = rows[np.abs(half_turn(bank.yaw[rows] - course)) > np.pi / 4]
    bank.size[across, :2], bank.known[across] = bank.size[across, 1::-1], bank.known[across, ::-1]
    bank.yaw[across], bank.held[across] = wrap_angle(bank.yaw[across] + np.pi / 2), 0.0
