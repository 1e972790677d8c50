"""A staged world for the faces: messages with known content, without simulator or perception."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest

from datmo.messages import (
    Boxes,
    Clusters,
    Frame,
    Ground,
    Kind,
    LostRays,
    Scan,
    Tracks,
    Truth,
    Visibility,
)
from scenarios.expect import UNITS
from scenarios.spec import Scenario

SIZES = np.array([[4.4, 1.8, 1.5], [8.0, 2.5, 3.2], [0.6, 0.6, 1.75]])
KINDS = np.array([Kind.CAR, Kind.TRUCK, Kind.PEDESTRIAN], np.uint8)


def true_boxes(t: float) -> Boxes:
    """A car that drives off, a parked truck, a walker."""
    return Boxes(
        center=np.array([[20 + 6 * t, 5, 0.75], [15, -9, 1.6], [8 - t, 12, 0.875]]),
        size=SIZES,
        yaw=np.array([0, 0.6, np.pi]),
        velocity=np.array([[6.0, 0], [0, 0], [-1, 0]]),
        id=np.array([4, 9, 300]),
        kind=KINDS,
    )


def staged(k: int = 0, n: int = 3000, yaw: float = 0.4) -> tuple[Frame, Truth]:
    """Frame `k` (10 Hz): the car is hidden in frames 5-9; the ego drives at 5 m/s."""
    rng = np.random.default_rng(100 + k)
    t, hidden = k / 10, 5 <= k < 10
    T = np.eye(4)
    T[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    T[:3, 3] = [5 * t * np.cos(yaw), 5 * t * np.sin(yaw), 1.73]
    boxes = true_boxes(t)
    r, a = rng.uniform(3, 48, n), rng.uniform(-np.pi, np.pi, n)
    parts, actor = [np.c_[r * np.cos(a), r * np.sin(a), np.full(n, -1.73)]], [-1] * n
    for row in range(3):
        if not (row == 0 and hidden):
            u = rng.uniform(-0.5, 0.5, (200, 3)) * SIZES[row]
            c, s = np.cos(boxes.yaw[row]), np.sin(boxes.yaw[row])
            world = np.c_[c * u[:, 0] - s * u[:, 1], s * u[:, 0] + c * u[:, 1], u[:, 2]] + boxes.center[row]
            parts.append((world - T[:3, 3]) @ T[:3, :3])
            actor += [row] * 200
    points = np.vstack(parts).astype(np.float32)
    scan = Scan(points=points, stamp=t, T_world_sensor=T, intensity=rng.uniform(0, 1, len(points)))
    truth = _truth(boxes, t, np.array(actor, np.int32), hidden)
    return _frame(k, scan, truth, hidden), truth


def _truth(boxes: Boxes, t: float, actor: np.ndarray, hidden: bool) -> Truth:
    m, is_ground = len(actor), actor < 0
    seen = Visibility.HIDDEN if hidden else Visibility.VISIBLE
    rays = np.array([0 if hidden else 200, 100, 30])
    return Truth(
        boxes=boxes,
        stamp=t,
        T_world_actor=np.broadcast_to(np.eye(4), (3, 4, 4)),
        actor=actor,
        thing=np.full(m, -1),
        kind=np.where(is_ground, Kind.ROAD, KINDS[actor]),
        is_ground=is_ground,
        height=np.full(m, -1.73),
        normal=np.zeros((m, 3)),
        solo=np.array([200, 200, 200]),
        visible=rays,
        returns=rays,
        lost_to=np.zeros((3, 5)),
        visibility=np.array([seen, Visibility.PARTIAL, Visibility.HEAVY]),
        lost=LostRays(*(np.zeros(0) for _ in range(6))),
    )


def _frame(k: int, scan: Scan, truth: Truth, hidden: bool) -> Frame:
    """20 points of the first object are called ground; the car's track changes id at frame 12."""
    m, called = len(scan), truth.is_ground.copy()
    called[np.flatnonzero(truth.actor >= 0)[:20]] = True
    tracks = Boxes(
        center=truth.boxes.center + 0.2,
        size=SIZES,
        yaw=truth.boxes.yaw,
        velocity=truth.boxes.velocity,
        id=np.array([11 if k < 12 else 31, 12, 13]),
    )
    return Frame(
        scan=scan,
        ground=Ground(called, np.full(m, -1.73 + 0.05), np.full(m, 0.1)),
        clusters=Clusters(truth.actor, 3),
        boxes=truth.boxes.select(np.unique(truth.actor[truth.actor >= 0])),
        tracks=Tracks(
            boxes=tracks,
            stamp=scan.stamp,
            status=np.array([min(k + 1, 10) if hidden else 5, 5, 5 if k > 2 else 2]),
            is_dynamic=np.array([True, False, True]),
        ),
        milliseconds={"ground": 30.0 + k % 3, "clusters": 8.0, "boxes": 5.0, "tracks": 12.0 + k % 5},
    )


class StagedTestbed:
    """Stands in for the Testbed: the same contract, staged frames, given results."""

    values: ClassVar[dict[str, float | None]] = {}

    def __init__(self, scenario: Scenario, ground: str | None = None) -> None:
        self.scenario, self.ground = scenario, ground
        self.lidar = SimpleNamespace(scenario=scenario, milliseconds={"traffic": 6.0, "cast": 40.0})

    def reset(self, seed: int | None = None) -> tuple[Any, dict[str, Any]]:
        self.seed, self.k = seed, 0
        return {}, self._info()

    def step(self, _action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        self.k += 1
        return {}, 0.5, False, self.k + 1 >= self.scenario.scans, self._info()

    def _info(self) -> dict[str, Any]:
        frame, truth = staged(self.k)
        metrics = {"ground.f1": 0.97, "detection.recall": None, "tracking.gospa": 1.25}
        return {"scan": frame.scan, "truth": truth, "frame": frame, "relief": None, "metrics": metrics}

    def result(self) -> list[Any]:
        base = {"ground.f1": 0.9712, "recovery.rate": None, "speed.step_ms": 120.0, "tracking.hota": 0.5}
        values = {name: base.get(name, 0.25) for name in UNITS} | self.values
        return [SimpleNamespace(name=name, value=values[name], unit=UNITS[name]) for name in UNITS]

    def detail(self) -> dict[str, Any]:
        return {"ground": {"by_range": {"0-10": np.float64(0.99)}, "worst": float("nan")}}

    def close(self) -> None:
        pass


@pytest.fixture
def stage() -> Any:
    """The factory of staged frames."""
    return staged


@pytest.fixture
def stage_testbed() -> Any:
    """The stand-in test-bed."""
    return StagedTestbed
