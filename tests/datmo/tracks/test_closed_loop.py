"""A bird's-eye world: movers, an occluder, partial boxes, misses, clutter, rays."""

from __future__ import annotations

import numpy as np
import pytest

from datmo.geometry import wrap_angle
from datmo.messages import Boxes, Sight
from datmo.messages.sight import AZIMUTH_STEP, ELEVATION_STEP, HIGHEST, LOWEST
from datmo.tracks import Tracker, TrackerConfig

SHAPE = (round((HIGHEST - LOWEST) / ELEVATION_STEP), round(2 * np.pi / AZIMUTH_STEP))
FAR = 90.0
TRUCK = np.array([10.0, 0.0, np.pi / 2, 8.0, 2.5])


def cast(things):
    """Range (a,) and the index of the thing met (-1 none) along each azimuth from the origin.

    things: rows x, y, yaw, length, width.
    """
    azimuth = -np.pi + (np.arange(SHAPE[1]) + 0.5) * AZIMUTH_STEP
    best, who = np.full(SHAPE[1], FAR), np.full(SHAPE[1], -1)
    for k, (x, y, yaw, length, width) in enumerate(things):
        c, s = np.cos(yaw), np.sin(yaw)
        start = np.array([-(c * x + s * y), s * x - c * y])
        ray = np.stack([np.cos(azimuth - yaw), np.sin(azimuth - yaw)])
        with np.errstate(divide="ignore"):
            a = (np.array([[length / 2], [width / 2]]) - start[:, None]) / ray
            b = (-np.array([[length / 2], [width / 2]]) - start[:, None]) / ray
        enter, leave = np.minimum(a, b).max(0), np.maximum(a, b).min(0)
        hit = (enter < leave) & (enter > 0) & (enter < best)
        best[hit], who[hit] = enter[hit], k
    return azimuth, best, who


def look(things, rng, misses=0.05, clutter=2):
    """Partial boxes of what is seen, clutter, the Sight, and the rays on each thing."""
    azimuth, reach, who = cast(things)
    points = reach[:, None] * np.column_stack([np.cos(azimuth), np.sin(azimuth)])
    rows, counts = [], np.bincount(who[who >= 0], minlength=len(things))
    for k, (x, y, yaw, *_) in enumerate(things):
        if counts[k] < 4 or rng.random() < misses:
            continue
        c, s = np.cos(yaw), np.sin(yaw)
        local = (points[who == k] - [x, y]) @ np.array([[c, -s], [s, c]])
        low, high = local.min(0) - 0.05, local.max(0) + 0.05
        middle = np.array([[c, -s], [s, c]]) @ ((low + high) / 2) + [x, y] + rng.normal(0, 0.05, 2)
        size, turn = np.maximum(high - low, 0.2), yaw + rng.normal(0, 0.04)
        if size[1] > size[0]:
            size, turn = size[::-1], turn + np.pi / 2
        rows.append([*middle, *size, wrap_angle(turn + np.pi * rng.integers(2))])
    rows += [[*rng.uniform(-40, 40, 2), 1.0, 0.8, 0.0] for _ in range(rng.poisson(clutter))]
    r = np.array(rows).reshape(-1, 5)
    order = rng.permutation(len(r))
    r = r[order]
    n = len(r)
    boxes = Boxes(
        center=np.column_stack([r[:, :2], np.zeros(n)]),
        size=np.column_stack([r[:, 2:4], np.full(n, 1.5)]),
        yaw=r[:, 4],
    )
    image = np.tile(reach, (SHAPE[0], 1))
    return boxes, Sight(near=image, far=image, T_world_sensor=np.eye(4)), counts


def straight(start, velocity, length=4.4, width=1.8):
    yaw = np.arctan2(velocity[1], velocity[0])
    return lambda t: [*(np.array(start) + t * np.array(velocity)), yaw, length, width]


MOVERS = [
    straight([20.0, -32.0], [0.0, 12.0]),
    straight([-15.0, -20.0], [0.0, 7.0]),
    straight([-30.0, 12.0], [9.0, 0.0]),
    straight([-8.0, 25.0], [0.0, -5.0], 0.8, 0.6),
]


def play(seed, config=None, with_sight=True, frames=55, engine="batched"):
    """Per frame: the tracks, the true rows and the rays on each."""
    rng, tracker = np.random.default_rng(seed), Tracker(config, engine=engine)
    for k in range(frames):
        things = np.array([TRUCK, *(m(0.1 * k) for m in MOVERS)])
        boxes, sight, counts = look(things, rng)
        yield tracker.step(boxes, 0.1 * k, sight if with_sight else None), things, counts, tracker


def owner(tracks, place, within=2.0):
    rows = np.flatnonzero(tracks.confirmed())
    if len(rows) == 0:
        return None
    gap = np.linalg.norm(tracks.boxes.center[rows, :2] - place[:2], axis=1)
    return int(tracks.boxes.id[rows[gap.argmin()]]) if gap.min() < within else None


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(n, marks=pytest.mark.long) for n in range(2, 6))])
def test_a_car_hidden_for_over_a_second_keeps_its_id(seed):
    ids, hidden, errors = [], [], []
    for tracks, things, counts, _ in play(seed):
        ids.append(owner(tracks, things[1]))
        hidden.append(counts[1] == 0)
        if hidden[-1]:
            gap = np.linalg.norm(tracks.boxes.center[:, :2] - things[1, :2], axis=1)
            errors.append(gap.min())
    first, last = np.flatnonzero(hidden)[[0, -1]]
    assert last - first >= 11
    before, after = ids[first - 1], ids[min(last + 6, len(ids) - 1)]
    assert before is not None
    assert after == before
    assert np.median(errors) < 1.5


def test_seen_objects_keep_one_id_and_their_true_size_and_place():
    """The truck's far side and the cars' far ends are never seen; their places must not suffer."""
    seen: dict[int, set[int | None]] = {}
    places, yaws = [], []
    for k, (tracks, things, counts, _) in enumerate(play(3)):
        for j in (2, 3, 4):
            if k > 12 and counts[j] >= 4:
                seen.setdefault(j, set()).add(owner(tracks, things[j]))
                rows = tracks.boxes.id == owner(tracks, things[j])
                if j < 4 and rows.any():
                    places.append(np.linalg.norm(tracks.boxes.center[rows][0, :2] - things[j, :2]))
                    yaws.append(wrap_angle(tracks.boxes.yaw[rows][0] - things[j, 2]))
    for ids in seen.values():
        assert len(ids - {None}) == 1
    assert np.median(places) < 0.5
    assert np.max(np.abs(yaws)) < 0.5


def test_without_expected_visibility_the_hidden_car_is_lost():
    """The control: what keeps the identity is the Sight."""
    kept = 0
    for seed in range(3):
        config = TrackerConfig(recall=False)
        ids, hidden = [], []
        for tracks, things, counts, _ in play(seed, config, with_sight=False):
            ids.append(owner(tracks, things[1]))
            hidden.append(counts[1] == 0)
        first, last = np.flatnonzero(hidden)[[0, -1]]
        kept += ids[first - 1] == ids[min(last + 6, len(ids) - 1)]
    assert kept == 0


def test_a_car_that_vanishes_in_plain_view_goes_soon():
    rng, tracker = np.random.default_rng(0), Tracker()
    gone, died = 2.0, None
    for k in range(60):
        t = 0.1 * k
        things = np.array([TRUCK, *([MOVERS[1](t)] if t < gone else [])])
        boxes, sight, _ = look(things, rng, misses=0, clutter=0)
        tracks = tracker.step(boxes, t, sight)
        if t >= gone and died is None and tracks.confirmed().sum() == 1:
            died = t - gone
    assert died is not None
    assert 0.2 <= died <= 0.9


def test_static_and_dynamic():
    *_, (tracks, things, _, _) = play(1, frames=40)
    labels = dict(zip(tracks.boxes.id.tolist(), tracks.is_dynamic.tolist(), strict=True))
    assert labels[owner(tracks, things[0])] is False
    assert labels[owner(tracks, things[2])] is True
