"""Every object of every scan of some episodes, and what detection made of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from datmo.config import DatmoConfig
from datmo.messages import Frame, Truth
from datmo.pipeline import Datmo
from eval.episode import episode, scans_to_play
from eval.metrics.detection import match_detections, pair_errors
from eval.metrics.diagnosis import diagnose
from eval.metrics.matching import Returns
from scenarios.spec import Scenario
from sim.env import LidarEnv


@dataclass(frozen=True)
class Job:
    """One episode to detect in."""

    scenario: Scenario
    seed: int
    frames: int | None
    config: DatmoConfig


@dataclass(frozen=True)
class Sighting:
    """One object in one scan, with ten returns or more.

    Attributes:
        scenario, seed, scan: where. kind, visibility: of the object, as numbers. distance: of its centre
        from the sensor [m]. returns: how many. found: whether a detection is matched to it.
        split, merged, stage: see `Diagnosis`. center_error, corner_error [m], yaw_error [rad], iou: of the
        detection, None without one; yaw of vehicles only.
    """

    scenario: str
    seed: int
    scan: int
    kind: int
    visibility: int
    distance: float
    returns: int
    found: bool
    split: bool
    merged: bool
    stage: int
    center_error: float | None
    corner_error: float | None
    yaw_error: float | None
    iou: float | None


def detect(job: Job) -> list[Sighting]:
    """Play one episode with the whole of perception in the loop, so that predictions come back."""
    env, datmo = LidarEnv(job.scenario), Datmo(job.config)
    try:
        infos = episode(env, job.scenario, job.seed, scans_to_play(job.scenario, job.frames))
        return [
            sighting
            for scan, info in enumerate(infos)
            for sighting in sightings(job, scan, datmo.step(info["scan"]), info["truth"])
        ]
    finally:
        env.close()


def sightings(job: Job, scan: int, frame: Frame, truth: Truth) -> Iterator[Sighting]:
    """Those of one scan."""
    matched = match_detections(frame, truth, Returns(frame, truth))
    told = diagnose(frame, truth, matched)
    actors, errors = pair_errors(frame, truth, matched)
    offset = truth.boxes.center[:, :2] - frame.scan.T_world_sensor[:2, 3]
    distance = np.hypot(offset[:, 0], offset[:, 1])
    row = {int(actor): i for i, actor in enumerate(actors)}

    def error(actor: int, name: str) -> float | None:
        value = errors[name][row[actor]] if actor in row else np.nan
        return None if np.isnan(value) else float(value)

    for k in np.flatnonzero(told.judged).tolist():
        yield Sighting(
            scenario=job.scenario.name,
            seed=job.seed,
            scan=scan,
            kind=int(truth.boxes.kind[k]),
            visibility=int(truth.visibility[k]),
            distance=float(distance[k]),
            returns=int(truth.returns[k]),
            found=bool(matched.found[k]),
            split=bool(told.split[k]),
            merged=bool(told.merged[k]),
            stage=int(told.stage[k]),
            center_error=error(k, "center_error"),
            corner_error=error(k, "corner_error"),
            yaw_error=error(k, "yaw_error"),
            iou=error(k, "iou"),
        )
