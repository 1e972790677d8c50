"""The box tracker: whole boxes from partial ones (Alg. 5-7, 4.1-4.2; method.md section 14)."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, I64, Bool
from datmo.messages import Boxes, Sight
from datmo.tracks.bank import Bank
from datmo.tracks.config import TrackerConfig
from datmo.tracks.gate import Pairs
from datmo.tracks.ukf import half_turn
from datmo.tracks.visibility import judge

CORNERS = np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]])  # of a box, by side
BESIDE, BEYOND = np.deg2rad(0.75), 0.2  # past a corner, at the least [rad], [m], rays tell whether it is real
HEIGHTS = np.array([-0.15, 0.0, 0.15, 0.3])  # where, in heights from the middle; not all rows have rays
FACE = np.deg2rad(0.75)  # a face of less is not seen as one
END_SLACK = 0.3  # [m] so much farther than the corner they must go
LEAST = 0.1  # [m] a missing extent below this is noise
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
    boxes: Boxes,
    factor: F64,
    track: I64,
    box: I64,
    sight: Sight | None,
    config: TrackerConfig,
) -> Pairs:
    """Each candidate pair's measurement as the track reads it: its own axes, its whole extent.

    Args:
        factor: (k,) how many times the usual noise each box has.
    """
    turn = half_turn(boxes.yaw[box] - bank.yaw[track])
    crossed = np.abs(turn) > np.pi / 4
    seen = np.where(crossed[:, None], boxes.size[box][:, 1::-1], boxes.size[box][:, :2])
    turned = bank.yaw[track] + np.where(crossed, turn - np.copysign(np.pi / 2, turn), turn)
    missing = np.maximum(bank.size[track, :2] - seen, 0)
    missing = np.where(missing < LEAST, 0.0, missing)
    shift = np.zeros((len(track), 2))
    whole = np.full((len(track), 2), sight is None)
    axes = np.stack([np.cos(turned), np.sin(turned), -np.sin(turned), np.cos(turned)], 1).reshape(-1, 2, 2)
    center = boxes.center[box]
    if sight is not None and config.correct_ends and len(track):
        then = center.copy()  # where it was when the rays met it
        then[:, :2] += sight.when(center)[:, None] * velocity(mean)[track]
        real = real_ends(sight, then, axes, seen, bank.size[track, 2])
        whole = np.asarray(real.all(axis=2))
        shift = whole_center(center[:, :2], axes, seen, missing, real, mean[track, :2], sight)
    missing = np.where(whole, 0.0, missing)
    certain = config.given_std if sight is None else (config.whole_std, config.whole_std)
    std = np.where(whole, certain, config.position_std)
    std, yaw_std = std * factor[box, None], config.yaw_std * factor[box]
    R = np.einsum("pa,pai,paj->pij", std**2 + (config.partial_std * missing) ** 2, axes, axes)
    yaw = np.where(yaw_is_sure(boxes.size, config), boxes.yaw, np.nan)[box]
    n = len(track)
    return Pairs(
        track, box, center[:, :2] + shift, R, seen, yaw, yaw_std**2, turned, whole,
        np.zeros(n), np.zeros(n),
    )  # fmt: skip


def velocity(mean: F64) -> F64:
    """(t, 2) [m/s] of states (t, n)."""
    return np.asarray(mean[:, 3, None] * np.column_stack([np.cos(mean[:, 2]), np.sin(mean[:, 2])]))


def real_ends(sight: Sight, center: F64, axes: F64, seen: F64, height: F64) -> Bool:
    """(p, 2, 2) by side and end (back, front): whether what was seen really ends there.

    So it does when rays pass beside the outermost corner of that end, to either hand, and meet
    nothing until well behind it. A corner that something nearer cuts off tells nothing, and a far one only
    where the face that leads to it was seen: an end behind the body itself cannot be told from the near one.

    Args:
        center: (p, 3) [m, world]. axes: (p, 2, 2) unit vectors along and across. seen: (p, 2) extent [m].
        height: (p,) [m].
    """
    sensor, real = sight.T_world_sensor[:2, 3], np.zeros((len(center), 2, 2), np.bool_)
    corners = np.einsum("ca,pa,pai->pci", CORNERS, seen / 2, axes) + (center[:, None, :2] - sensor)
    middle, rows = center[:, :2] - sensor, np.arange(len(center))
    cross = middle[:, None, 0] * corners[..., 1] - middle[:, None, 1] * corners[..., 0]
    bearing = np.arctan2(cross, np.einsum("pi,pci->pc", middle, corners))
    distance = np.hypot(corners[..., 0], corners[..., 1])
    for hand in (-1.0, 1.0):
        outer = np.argmax(hand * bearing, axis=1)
        x, y = corners[rows, outer].T
        beside = hand * np.maximum(BESIDE, BEYOND / np.maximum(np.hypot(x, y), 1.0))
        c, s = np.cos(beside), np.sin(beside)
        places = np.zeros((len(center), len(HEIGHTS), 3))
        places[..., 0], places[..., 1] = (sensor[0] + c * x - s * y)[:, None], (sensor[1] + s * x + c * y)[:, None]
        places[..., 2] = center[:, 2, None] + HEIGHTS * height[:, None]
        _, empty, _ = judge(sight, places.reshape(-1, 3), np.zeros(places[..., 0].size), END_SLACK)
        passed = empty.reshape(-1, len(HEIGHTS)).any(axis=1)
        for side in range(2):
            other = outer ^ (2 >> side)  # the corner at the other end
            ahead = hand * (bearing[rows, outer] - bearing[rows, other]) > FACE
            told = ahead | (distance[rows, outer] < distance[rows, other])
            real[rows, side, (CORNERS[outer, side] > 0).astype(int)] |= passed & told
    return real


def whole_center(
    center: F64, axes: F64, seen: F64, missing: F64, real: Bool, predicted: F64, sight: Sight
) -> F64:
    """Shift (p, 2) [m, world] of each centre by half the missing extent, away from the real end.

    Where the rays do not tell the ends apart: away from the sensor when it stands beyond an end,
    else towards the predicted centre, never by more than half the missing extent.
    """
    sensor = np.einsum("pai,pi->pa", axes, sight.T_world_sensor[:2, 3] - center)
    wanted = np.einsum("pai,pi->pa", axes, predicted - center)
    half = missing / 2
    default = np.where(
        np.abs(sensor) >= (seen + missing) / 2, -np.sign(sensor) * half, np.clip(wanted, -half, half)
    )
    back, front = real[:, :, 0], real[:, :, 1]
    along = np.where(back & ~front, half, np.where(front & ~back, -half, np.where(back & front, 0, default)))
    return np.asarray(np.einsum("pa,pai->pi", along, axes))


def retain(
    bank: Bank, boxes: Boxes, factor: F64, pairs: Pairs, mean: F64, dt: float, config: TrackerConfig
) -> None:
    """Take the associated boxes (one pair a track) into the retained ones.

    Dimensions grow quickly and shrink slowly; the heading follows sure yaws, and the motion of a
    fast track without one; the height follows with its rate, so that a hidden track climbs on.
    """
    t, b, doubt = pairs.track, pairs.box, factor[pairs.box]
    seen = np.column_stack([pairs.seen, boxes.size[b, 2]])
    old = bank.size[t]
    whole = np.column_stack([pairs.whole, pairs.whole.all(axis=1)])
    grow = np.where(whole, config.whole_gain, config.grow)
    shrink = np.where(whole, config.whole_gain, config.shrink)
    gain = np.where(seen > old, np.where(seen > LEAP * old + 0.5, MERGER_GAIN, grow), shrink)
    bank.known[t] |= pairs.whole.astype(bool)
    bank.size[t] = old + damped(gain, doubt[:, None]) * (seen - old)
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


def damped(gain: F64 | float, factor: F64) -> F64:
    """A steady filter's gain for a measurement of `factor` times the noise."""
    return np.asarray(gain / (gain + (1 - gain) * factor**2))
