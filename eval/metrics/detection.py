"""Detections against the true boxes that have at least five returns."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import Any

import numpy as np

from datmo.arrays import F64, I64, U8, Bool
from datmo.geometry import corners_bev, half_turn, overlap_bev
from datmo.messages import VEHICLES, Frame, Kind, Truth, is_any
from eval.metrics.matching import Returns, assign, distances, gates
from eval.metrics.ratio import mean, ratio, spread

LEAST_RETURNS = 5
NEAR = 40.0


@dataclass(frozen=True)
class Matched:
    """The verdict on the detections of one scan.

    Attributes:
        actor: (m,) row in `Truth.boxes` that each detection is matched to, -1 none.
        false: (m,) neither matched, nor near an actor with few returns, nor made of things.
        clutter: (m,) left over and made of things' returns.
        valid: (k,) actors with at least five returns. found: (k,) those that are matched.
    """

    actor: I64
    false: Bool
    clutter: Bool
    valid: Bool
    found: Bool


def match_detections(frame: Frame, truth: Truth, returns: Returns) -> Matched:
    """Match by Hungarian on bird's-eye centre distance within each object's gate."""
    boxes, objects = frame.boxes, truth.boxes
    valid = truth.returns >= LEAST_RETURNS
    distance = distances(boxes.center, objects.center)
    within = distance <= gates(objects)
    detection, row = assign(distance, within & valid)
    actor = np.full(len(boxes), -1, np.int64)
    actor[detection] = row
    found = np.zeros(len(objects), bool)
    found[row] = True

    ignored = (within & ~valid).any(1)
    left = np.flatnonzero((actor < 0) & ~ignored)
    clutter = np.zeros(len(boxes), bool)
    clutter[left] = returns.on_things(boxes.select(left))[0]
    return Matched(actor, (actor < 0) & ~ignored & ~clutter, clutter, valid, found)


def pair_errors(frame: Frame, truth: Truth, matched: Matched) -> tuple[I64, dict[str, F64]]:
    """The actors (m,) of the matched detections, and the errors (m,) of those by name.

    center_error: bird's-eye distance of the centres [m]. yaw_error: modulo 180 degrees, vehicles; NaN for
    others [rad]. iou: rotated, bird's-eye. corner_error: from the true corner nearest to the sensor to
    the nearest corner of the detection [m]. length_error: [m].
    """
    d = np.flatnonzero(matched.actor >= 0)
    found, true = frame.boxes.select(d), truth.boxes.select(matched.actor[d])
    turn = half_turn(found.yaw - true.yaw)
    a, b = corners_bev(found.center, found.size, found.yaw), corners_bev(true.center, true.size, true.yaw)
    sensor = frame.scan.T_world_sensor[:2, 3]
    nearest = np.argmin(np.linalg.norm(b - sensor, axis=2), axis=1)
    corner = b[np.arange(len(d)), nearest]
    shared = np.array([overlap_bev(p, q) for p, q in zip(a, b, strict=True)])
    area = found.size[:, 0] * found.size[:, 1] + true.size[:, 0] * true.size[:, 1]
    return matched.actor[d], {
        "center_error": np.linalg.norm((found.center - true.center)[:, :2], axis=1),
        "yaw_error": np.where(is_any(true.kind, VEHICLES), np.abs(turn), np.nan),
        "iou": shared / (area - shared),
        "corner_error": np.linalg.norm(a - corner[:, None], axis=2).min(1),
        "length_error": found.size[:, 0] - true.size[:, 0],
    }


class DetectionScores:
    """Counts and errors over the scans of a run."""

    def __init__(self) -> None:
        self.hits = self.false = self.clutter = self.ignored = 0
        self.objects = 0
        self._near_vehicles: list[bool] = []
        self._kind: list[int] = []
        self._found: list[bool] = []
        self._errors: dict[str, list[float]] = defaultdict(list)

    def add(self, frame: Frame, truth: Truth, matched: Matched) -> None:
        """Take in one scan."""
        hits = int((matched.actor >= 0).sum())
        self.hits += hits
        self.false += int(matched.false.sum())
        self.clutter += int(matched.clutter.sum())
        self.ignored += int(len(frame.boxes) - hits - matched.false.sum() - matched.clutter.sum())
        self.objects += int(matched.valid.sum())
        near = near_vehicles(truth.boxes.center, truth.boxes.kind, frame.scan.T_world_sensor)
        self._near_vehicles += matched.found[near & matched.valid].tolist()
        self._kind += truth.boxes.kind[matched.valid].tolist()
        self._found += matched.found[matched.valid].tolist()
        for name, values in pair_errors(frame, truth, matched)[1].items():
            self._errors[name] += values[~np.isnan(values)].tolist()

    def join(self, other: DetectionScores) -> None:
        """Take in what another has counted."""
        self.hits += other.hits
        self.false += other.false
        self.clutter += other.clutter
        self.ignored += other.ignored
        self.objects += other.objects
        self._near_vehicles += other._near_vehicles
        self._kind += other._kind
        self._found += other._found
        for name, values in other._errors.items():
            self._errors[name] += values

    def scores(self) -> dict[str, float | None]:
        """The named scores."""
        return {
            "detection.precision": ratio(self.hits, self.hits + self.false),
            "detection.recall": ratio(self.hits, self.objects),
            "detection.recall_vehicles_40m": mean(self._near_vehicles),
            "detection.center_error": mean(self._errors["center_error"]),
            "detection.yaw_error": mean(self._errors["yaw_error"]),
            "detection.iou": mean(self._errors["iou"]),
        }

    def detail(self) -> dict[str, Any]:
        """What stands beside: spreads, recall by kind, clutter and ignored detections."""
        kind, found = np.array(self._kind, int), np.array(self._found, bool)
        kinds = {Kind(k).name.lower(): mean(found[kind == k]) for k in np.unique(kind).tolist()}
        return {
            "objects": self.objects,
            "matched": self.hits,
            "false": self.false,
            "clutter": self.clutter,
            "ignored": self.ignored,
            "recall_of_kind": kinds,
            **{name: spread(values) for name, values in sorted(self._errors.items())},
        }


def near_vehicles(center: F64, kind: U8, T_world_sensor: F64) -> Bool:
    """(k,) vehicles whose centre lies within 40 m of the sensor, seen from above."""
    offset = center[:, :2] - T_world_sensor[:2, 3]
    return is_any(kind, VEHICLES) & (np.hypot(offset[:, 0], offset[:, 1]) <= NEAR)
