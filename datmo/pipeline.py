"""Datmo: the whole of perception, one scan at a time; the only file that joins the stages."""

from __future__ import annotations

from time import perf_counter

import numpy as np

from datmo.arrays import F64
from datmo.boxes import fit_boxes
from datmo.carry import carry
from datmo.clusters import cluster, merge_clusters, split_clusters
from datmo.config import DatmoConfig
from datmo.geometry import transform
from datmo.ground import GroundSegmenter
from datmo.messages import Frame, Ground, Scan
from datmo.refine import refine
from datmo.sight import make_sight
from datmo.tracks import Tracker


class Datmo:
    """Detection and tracking of moving objects; one instance follows one sensor through time.

    Any HDL-64 cloud will do, real ones too: `Datmo().step(Scan(points=xyz))`. A scan whose stamp does
    not follow the last one begins a new sequence: the tracks end, and `Frame.notes` says so.
    """

    def __init__(self, config: DatmoConfig | None = None) -> None:
        self.config = config or DatmoConfig()
        self.ground = GroundSegmenter(self.config.ground)
        self.tracker = Tracker(self.config.tracks)
        self._stamp = -np.inf

    def reset(self) -> None:
        """Forget every track and what was learned; the next scan begins a new sequence."""
        self.ground.reset()
        self.tracker.reset()
        self._stamp = -np.inf

    def step(self, scan: Scan) -> Frame:
        """One scan in, everything known after it out."""
        clock = Stopwatch()
        notes = self._follow(scan.stamp)
        keep = refine(scan, self.config.refine)
        clock.lap("refine")
        ground = self.ground.step(scan.points, keep)
        clock.lap("ground")
        height_above = scan.points[:, 2] - ground.height
        elevated = keep & ~ground.is_ground
        clusters = cluster(scan.points, height_above, elevated, self.config.clusters)
        predicted = self.tracker.predicted(scan.stamp)
        places = transform(scan.T_world_sensor, scan.points)
        clusters = split_clusters(places, clusters, predicted, scan.dt, self.config.split)
        places = carry(places, scan, clusters, predicted, self.config.carry)
        clusters = merge_clusters(places, clusters, predicted, self.config.merge)
        clock.lap("clusters")
        boxes, rejected = fit_boxes(
            places, clusters, ground_below(scan, ground), scan.T_world_sensor[:2, 3], self.config.boxes
        )
        clock.lap("boxes")
        sight = make_sight(scan, keep)
        tracks = self.tracker.step(boxes, scan.stamp, sight)
        clock.lap("tracks")
        notes |= {f"ground {k}": note for k, note in enumerate(self.ground.learned.notes)}
        notes |= self.tracker.notes | {f"cluster {r.cluster}": str(r) for r in rejected}
        return Frame(scan, ground, clusters, boxes, tracks, clock.milliseconds, notes)

    def _follow(self, stamp: float) -> dict[str, str]:
        """Begin a new sequence where time does not go on."""
        last, notes = self._stamp, {}
        if stamp <= last:
            self.reset()
            notes["sequence"] = f"stamp {stamp} s does not follow {last} s: a new sequence, all tracks ended"
        self._stamp = stamp
        return notes


class Stopwatch:
    """Milliseconds between laps, by name."""

    def __init__(self) -> None:
        self.milliseconds: dict[str, float] = {}
        self._last = perf_counter()

    def lap(self, name: str) -> None:
        """Note the time since the last lap under `name`."""
        now = perf_counter()
        self.milliseconds[name] = (now - self._last) * 1e3
        self._last = now


def ground_below(scan: Scan, ground: Ground) -> F64:
    """World height (n,) [m] of the ground where the line through each point along z meets it."""
    T = scan.T_world_sensor[2]
    x, y = scan.points[:, 0].astype(float), scan.points[:, 1].astype(float)
    return np.asarray(T[0] * x + T[1] * y + T[2] * ground.height + T[3])
