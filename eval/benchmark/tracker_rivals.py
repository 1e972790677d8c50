"""Trackers behind one small face: ours, ours as the thesis has it, and a plain Kalman filter."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from scipy.optimize import linear_sum_assignment

from datmo.arrays import I64
from datmo.geometry import half_turn, wrap_angle
from datmo.messages import Boxes, Status
from datmo.tracks import Tracker, TrackerConfig

THESIS = TrackerConfig(
    use_yaw=False,
    weigh_shape=False,
    cv_keeps_yaw_rate=True,
    freeze_unseen=False,
    mix_yaw_rate=True,
    clutter="nonparametric",
    confirm_hits=5,
    birth_misses=0,
    max_coast=0.5,
    recall=False,
    scores="ignored",
    hold_back=False,
    position_std=0.15,
    given_std=(0.08, 0.08),
)
"""As near to the printed thesis as this tracker comes: position alone is measured, a miss ends a new
track, five states of drifting at 10 Hz, textbook mixing, clutter by the gate's volume."""


class Rival(Protocol):
    """What takes the boxes of one scan after another."""

    def reset(self) -> None:
        """Begin a new sequence."""

    def step(self, boxes: Boxes, stamp: float) -> Boxes:
        """The tracks reported for this scan; `id` is the track. `stamp` [s]."""


class Ours:
    """This project's tracker.

    Args:
        config: tuning.
        coasting: report confirmed tracks that this scan did not hit, too.
    """

    def __init__(self, config: TrackerConfig | None = None, coasting: bool = True) -> None:
        self._config, self._coasting = config, coasting
        self.reset()

    def reset(self) -> None:
        """See `Rival`."""
        self._tracker = Tracker(self._config)

    def step(self, boxes: Boxes, stamp: float) -> Boxes:
        """See `Rival`."""
        tracks = self._tracker.step(boxes, stamp)
        shown = tracks.confirmed() if self._coasting else tracks.status == Status.TRACKING
        return tracks.boxes.select(shown)


class PlainKalman:
    """Constant velocity in the world, one filter for all three axes; Hungarian on centre distance.

    Birth after three hits in a row, death after two misses, as AB3DMOT (Weng et al., IROS 2020), which
    filters in the frame of the sensor. Size and yaw follow the boxes.

    Args:
        min_score: boxes with a lower score are left out; 1 suits it best on PointRCNN's cars.
        coasting: report tracks that this scan did not hit, too.
    """

    GATE, HITS, MISSES = 3.0, 3, 2  # [m] and scans
    POSITION_STD, SPEED_STD, ACCEL_DENSITY = 0.3, 10.0, 4.0  # [m], [m/s], [m²/s³]
    FOLLOW = 0.3  # share of a new box in the size and the yaw

    def __init__(self, min_score: float = 1.0, coasting: bool = False) -> None:
        self._min_score, self._coasting, self._next = min_score, coasting, 1
        self.reset()

    def reset(self) -> None:
        """See `Rival`."""
        self._p, self._v, self._P = np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 2, 2))
        self._boxes, self._stamp = Boxes.empty(), 0.0
        self._hits, self._misses = np.zeros(0, np.int64), np.zeros(0, np.int64)

    def step(self, boxes: Boxes, stamp: float) -> Boxes:
        """See `Rival`."""
        boxes = boxes.select(boxes.score >= self._min_score)
        self._predict(stamp)
        track, box = self._match(boxes)
        self._correct(track, boxes.select(box))
        missed = np.ones(len(self._p), np.bool_)
        missed[track] = False
        self._misses = np.where(missed, self._misses + 1, 0)
        self._hits[track] += 1
        free = np.ones(len(boxes), np.bool_)
        free[box] = False
        self._keep_and_start(boxes.select(free))
        shown = (self._hits >= self.HITS) & (self._coasting | (self._misses == 0))
        return self._boxes.select(shown)

    def _predict(self, stamp: float) -> None:
        dt, self._stamp = stamp - self._stamp, stamp
        F, q = np.array([[1, dt], [0, 1]]), self.ACCEL_DENSITY
        self._p = self._p + dt * self._v
        self._P = F @ self._P @ F.T + q * np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]])

    def _match(self, boxes: Boxes) -> tuple[I64, I64]:
        distance = np.linalg.norm(self._p[:, None, :2] - boxes.center[None, :, :2], axis=2)
        track, box = linear_sum_assignment(np.minimum(distance, self.GATE))
        near = distance[track, box] < self.GATE
        return track[near], box[near]

    def _correct(self, track: I64, boxes: Boxes) -> None:
        K = self._P[track, :, 0] / (self._P[track, 0, 0] + self.POSITION_STD**2)[:, None]
        gap = boxes.center - self._p[track]
        self._p[track] += K[:, :1] * gap
        self._v[track] += K[:, 1:] * gap
        self._P[track] -= K[:, :, None] * self._P[track, :1]
        size, yaw = self._boxes.size.copy(), self._boxes.yaw.copy()
        size[track] += self.FOLLOW * (boxes.size - size[track])
        yaw[track] += self.FOLLOW * half_turn(boxes.yaw - yaw[track])
        self._boxes = Boxes(self._p, size, wrap_angle(yaw), id=self._boxes.id)

    def _keep_and_start(self, born: Boxes) -> None:
        kept, n = np.flatnonzero(self._misses < self.MISSES), len(born)
        ids = np.concatenate([self._boxes.id[kept], self._next + np.arange(n)])
        self._next += n
        start = np.diag([self.POSITION_STD**2, self.SPEED_STD**2])
        self._p = np.concatenate([self._p[kept], born.center])
        self._v = np.concatenate([self._v[kept], np.zeros((n, 3))])
        self._P = np.concatenate([self._P[kept], np.tile(start, (n, 1, 1))])
        self._hits = np.concatenate([self._hits[kept], np.ones(n, np.int64)])
        self._misses = np.concatenate([self._misses[kept], np.zeros(n, np.int64)])
        size = np.concatenate([self._boxes.size[kept], born.size])
        self._boxes = Boxes(self._p, size, np.concatenate([self._boxes.yaw[kept], born.yaw]), id=ids)


def rivals() -> dict[str, Rival]:
    """All that are compared, by name."""
    return {
        "ours": Ours(),
        "ours, hits alone": Ours(coasting=False),
        "thesis": Ours(THESIS),
        "Kalman": PlainKalman(),
        "Kalman, with what coasts": PlainKalman(coasting=True),
    }
