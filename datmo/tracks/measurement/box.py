"""The box tracker: whole boxes from partial ones (Alg. 5-7, 4.1-4.2; method.md section 14)."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, I64, Bool
from datmo.geometry import axes_of, half_turn
from datmo.messages import Boxes, Sight
from datmo.tracks.bank import Bank
from datmo.tracks.config import TrackerConfig
from datmo.tracks.measurement.ends import anchor, moved_middle, real_ends
from datmo.tracks.measurement.measured import Measured
from datmo.tracks.measurement.pairs import Pairs
from datmo.tracks.models import velocity

LEAST = 0.1  # [m] a missing extent below this is noise
VEHICLE = 2.5  # [m] whoever shows a side so long is a vehicle, of which the detector knows the other side
LEAP = 1.5  # a box this many times the retained one is taken for a merger first
MERGER_GAIN = 0.05
CLIMB_GAIN, HEIGHT_GAIN, MAX_GRADE = 0.05, 0.4, 0.2


def yaw_is_sure(size: F64, config: TrackerConfig) -> Bool:
    """(k,) whether the sides of a box differ enough to tell its heading, up to half a turn."""
    return np.asarray(
        config.use_yaw & (size[:, 0] >= config.yaw_length) & (size[:, 0] >= config.yaw_ratio * size[:, 1])
    )


def read(
    bank: Bank,
    mean: F64,
    given: Measured,
    track: I64,
    box: I64,
    sight: Sight | None,
    config: TrackerConfig,
) -> Pairs:
    """Each candidate pair's measurement as the track reads it: its own axes, its whole extent."""
    boxes, factor = given.boxes, given.factor[box, None]
    turn = half_turn(boxes.yaw[box] - bank.yaw[track])
    crossed = np.abs(turn) > np.pi / 4
    turned = bank.yaw[track] + np.where(crossed, turn - np.copysign(np.pi / 2, turn), turn)
    seen = along_axes(boxes.size[box], crossed)
    missing = bank.size[track, :2] - seen
    missing = np.where(np.abs(missing) < LEAST, 0.0, missing)
    axes = axes_of(turned)
    center, real = boxes.center[box], np.full((len(track), 2, 2), sight is None)
    shift = np.zeros((len(track), 2))
    if sight is not None and config.correct_ends and len(track):
        then = center.copy()  # where it was when the rays met it
        then[:, :2] += sight.when(center)[:, None] * velocity(mean)[track]
        real = real_ends(sight, then, axes, seen, bank.size[track, 2])
        shift = whole_center(center[:, :2], axes, seen, missing, real, mean[track, :2], sight)
    whole = np.asarray(real.all(axis=2))
    cut = np.where(whole, 0.0, np.maximum(missing, 0))
    certain = config.given_std if sight is None else (config.whole_std, config.whole_std)
    std = np.where(whole, certain, config.position_std) * factor
    var = std**2 + (config.partial_std * cut) ** 2
    var += np.where(real.any(axis=2), 0.0, config.unknown_end_std * cut) ** 2
    R = np.einsum("pa,pai,paj->pij", var, axes, axes)
    yaw = np.where(yaw_is_sure(boxes.size, config), boxes.yaw, np.nan)[box]
    part = 1 + config.partial_yaw * cut[:, 0] / np.maximum(seen[:, 0], LEAST)
    yaw_var, none = (config.yaw_std * factor[:, 0] * part) ** 2, np.zeros(len(track))
    return Pairs(track, box, center[:, :2] + shift, R, seen, yaw, yaw_var, turned, real, none, none)


def own_ends(sight: Sight, boxes: Boxes) -> Bool:
    """(k, 2, 2) by side and end (back, front): whether those of boxes as the rays met them are real."""
    return real_ends(sight, boxes.center, axes_of(boxes.yaw), boxes.size[:, :2], boxes.size[:, 2])


def along_axes(size: F64, crossed: Bool) -> F64:
    """(p, 2) length and width, which change places where the box lies across the track."""
    return np.where(crossed[:, None], size[:, 1::-1], size[:, :2])


def whole_center(
    center: F64, axes: F64, seen: F64, missing: F64, real: Bool, predicted: F64, sight: Sight
) -> F64:
    """Shift (p, 2) [m, world] of each centre by half the missing extent, away from the real end.

    So that end stays where it was seen; where more is seen than was retained, the centre moves towards it.
    Where the rays do not tell the ends apart: away from the sensor when it stands beyond an end,
    else towards the predicted centre, never by more than half the missing extent.
    """
    sensor = np.einsum("pai,pi->pa", axes, sight.T_world_sensor[:2, 3] - center)
    wanted = np.einsum("pai,pi->pa", axes, predicted - center)
    half = np.maximum(missing, 0) / 2
    default = np.where(
        np.abs(sensor) >= seen / 2 + half, -np.sign(sensor) * half, np.clip(wanted, -half, half)
    )
    along = np.where(real.any(axis=2), -anchor(real) * missing / 2, default)
    return np.asarray(np.einsum("pa,pai->pi", along, axes))


def retain(bank: Bank, given: Measured, pairs: Pairs, mean: F64, dt: float, config: TrackerConfig) -> F64:
    """Take the associated boxes (one pair a track) into the retained ones; the mean (t, n) after it.

    Dimensions grow quickly and shrink slowly; the heading follows sure yaws, and the motion of a
    fast track without one; the height follows with its rate, so that a hidden track climbs on.
    """
    boxes, t, b, doubt = given.boxes, pairs.track, pairs.box, given.factor[pairs.box]
    bank.known[t] |= pairs.whole
    mean = _resize(bank, given, pairs, mean, config)
    sure = np.isfinite(pairs.yaw)
    moves = np.abs(mean[t, 3]) > 2
    target = np.where(sure, pairs.yaw, mean[t, 2])
    step = np.where(sure | moves, np.where(moves, 0.5, 0.2), 0.0)
    bank.yaw[t] += damped(step, doubt) * half_turn(target - bank.yaw[t])
    limit = MAX_GRADE * np.abs(mean[t, 3])
    error = boxes.center[b, 2] - bank.z[t]
    bank.z[t] += damped(HEIGHT_GAIN, doubt) * error
    climb = damped(CLIMB_GAIN, doubt) * error / max(dt, 1e-3)
    bank.climb[t] = np.clip(bank.climb[t] + climb, -limit, limit)
    bank.score[t], bank.kind[t] = boxes.score[b], boxes.kind[b]
    return mean


def _resize(bank: Bank, given: Measured, pairs: Pairs, mean: F64, config: TrackerConfig) -> F64:
    """Retained dimensions: what was seen; of a vehicle's side never seen whole also what is expected.

    As they change the middle moves, while the real end stays.
    """
    t, b, boxes = pairs.track, pairs.box, given.boxes
    seen = np.column_stack([pairs.seen, boxes.size[b, 2]])
    old = bank.size[t]
    whole = np.column_stack([pairs.whole, pairs.whole.all(axis=1)])
    grow = np.where(seen > LEAP * old + 0.5, MERGER_GAIN, config.grow)
    partial = np.where(seen > old, grow, config.shrink)
    gain = np.where(whole, config.whole_gain, partial)
    size = old + damped(gain, given.factor[b, None]) * (seen - old)
    expected = along_axes(given.expected[b], np.abs(half_turn(pairs.turned - boxes.yaw[b])) > np.pi / 4)
    told = ~bank.known[t] & (pairs.seen.max(axis=1) >= VEHICLE)[:, None]
    more = np.where(told, np.maximum(expected - size[:, :2], 0.0), 0.0)
    size[:, :2] += config.expected_gain * more
    bank.size[t] = size
    held = anchor(pairs.real)
    bank.held[t] = np.where(held == 0, bank.held[t], held)
    shift = np.zeros((len(bank), 2))
    shift[t] = moved_middle(held, (size - old)[:, :2], pairs.turned)
    bank.shift(shift)
    return np.column_stack([mean[:, :2] + shift, mean[:, 2:]])


def damped(gain: F64 | float, factor: F64) -> F64:
    """A steady filter's gain for a measurement of `factor` times the noise."""
    return np.asarray(gain / (gain + (1 - gain) * factor**2))
