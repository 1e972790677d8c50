"""Objects of an episode worth a picture: one of each sort, as detection saw it, beside the truth."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from datmo.arrays import F64, I32
from datmo.config import DatmoConfig
from datmo.geometry import inverse, rotation_z, transform
from datmo.messages import Boxes, Detections, Frame, Kind, Truth, Visibility
from datmo.pipeline import Datmo
from eval.benchmark.sightings import Job
from eval.episode import episode, scans_to_play
from eval.metrics.detection import match_detections
from eval.metrics.diagnosis import diagnose
from eval.metrics.matching import Returns
from sim.env import LidarEnv

AROUND = 1.5
"""What is drawn beyond the true box [m]."""
SORTS = {
    (Kind.CAR, Visibility.VISIBLE): "car in full view",
    (Kind.CAR, Visibility.PARTIAL): "car partly hidden",
    (Kind.CAR, Visibility.HEAVY): "car mostly hidden",
    (Kind.VAN, Visibility.VISIBLE): "van in full view",
    (Kind.TRUCK, Visibility.VISIBLE): "lorry in full view",
    (Kind.TRUCK, Visibility.PARTIAL): "lorry partly hidden",
    (Kind.BUS, Visibility.VISIBLE): "bus in full view",
    (Kind.PEDESTRIAN, Visibility.VISIBLE): "person in full view",
    (Kind.PEDESTRIAN, Visibility.PARTIAL): "person partly hidden",
}
"""Kind and visibility, and what the picture is called."""
NEAREST, FARTHEST = 8.0, 35.0
"""From where to where an object shows what detection must cope with [m]."""


@dataclass(frozen=True, eq=False)
class Portrait:
    """One object in one scan, in a frame at its true place: x along its length, z up from its base.

    Attributes:
        title: what it is. points: (n, 3) obstacle returns on and about it, its own at the stamp [m].
        label: (n,) cluster of each, -1 none. truth: its true box. found: the boxes of its clusters.
        sensor: (2,) direction to the sensor [unit].
    """

    title: str
    points: F64
    label: I32
    truth: Boxes
    found: Detections
    sensor: F64


def portraits(job: Job, alone: DatmoConfig) -> dict[str, Portrait]:
    """Of each sort the object with most returns, and one that clusters split, without and with feedback.

    Args:
        job: the episode. alone: the same configuration without feedback of the tracker.
    """
    best: dict[str, tuple[float, Portrait]] = {}
    env, whole, without = LidarEnv(job.scenario), Datmo(job.config), Datmo(alone)
    try:
        infos = episode(env, job.scenario, job.seed, scans_to_play(job.scenario, job.frames))
        for info in infos:
            truth = info["truth"]
            one, other = (_Told(datmo.step(info["scan"]), truth) for datmo in (whole, without))
            for title, k, told in _worth(one, other, truth):
                value = float(truth.returns[k])
                if value > best.get(title, (0.0,))[0]:
                    best[title] = value, portrait(title, told.frame, truth, k)
    finally:
        env.close()
    return {title: made for title, (_, made) in best.items()}


class _Told:
    """A frame and what became of its objects."""

    def __init__(self, frame: Frame, truth: Truth) -> None:
        self.frame = frame
        self.told = diagnose(frame, truth, match_detections(frame, truth, Returns(frame, truth)))


def _worth(one: _Told, other: _Told, truth: Truth) -> Iterator[tuple[str, int, _Told]]:
    """What may be drawn of a scan: title, object, and whose frame."""
    offset = truth.boxes.center[:, :2] - one.frame.scan.T_world_sensor[:2, 3]
    distance = np.hypot(offset[:, 0], offset[:, 1])
    fit = one.told.judged & (distance > NEAREST) & (distance < FARTHEST)
    for k in np.flatnonzero(fit).tolist():
        title = SORTS.get((Kind(truth.boxes.kind[k]), Visibility(truth.visibility[k])))
        if title is not None:
            yield title, k, one
        if other.told.split[k] and not one.told.split[k]:
            kind = Kind(truth.boxes.kind[k]).name.lower()
            yield f"split {kind}, no feedback", k, other
            yield f"split {kind}, with feedback", k, one


def portrait(title: str, frame: Frame, truth: Truth, k: int) -> Portrait:
    """Object k of one scan."""
    scan, box = frame.scan, truth.boxes.select(np.array([k]))
    places = transform(scan.T_world_sensor, scan.points)
    own, velocity = truth.actor == k, box.velocity[0]
    places[own, :2] -= np.nan_to_num(velocity) * scan.dt[own, None].astype(float)
    T_world_object = np.eye(4)
    T_world_object[:3, :3] = rotation_z(box.yaw[0])
    T_world_object[:3, 3] = box.center[0] - [0, 0, box.size[0, 2] / 2]
    T_object_world = inverse(T_world_object)
    local = transform(T_object_world, places)
    half = box.size[0, :2] / 2 + AROUND
    near = ~frame.ground.is_ground & (np.abs(local[:, :2]) < half).all(1) & (local[:, 2] < box.size[0, 2] + 1)
    label = frame.clusters.label
    assert isinstance(frame.boxes, Detections)
    mine = np.isin(frame.boxes.cluster, label[own & (label >= 0)])
    found = frame.boxes.select(mine)
    sensor = transform(T_object_world, scan.T_world_sensor[None, :3, 3])[0, :2]
    return Portrait(
        title=title,
        points=local[near],
        label=label[near],
        truth=replace(box, center=transform(T_object_world, box.center), yaw=np.zeros(1)),
        found=replace(found, center=transform(T_object_world, found.center), yaw=found.yaw - box.yaw[0]),
        sensor=sensor / max(float(np.hypot(*sensor)), 1e-9),
    )
