"""Datmo: the whole of perception, one scan at a time; the only file that joins the stages."""

from __future__ import annotations

from time import perf_counter

from datmo.boxes import fit_boxes
from datmo.clusters import cluster, merge_clusters
from datmo.config import DatmoConfig
from datmo.geometry import transform
from datmo.ground import GroundSegmenter
from datmo.messages import Frame, Scan
from datmo.refine import refine
from datmo.sight import make_sight
from datmo.tracks import Tracker


class Datmo:
    """Detection and tracking of moving objects; one instance follows one sensor through time.

    Any HDL-64 cloud will do, real ones too: `Datmo().step(Scan(points=xyz))`.
    """

    def __init__(self, config: DatmoConfig | None = None) -> None:
        self.config = config or DatmoConfig()
        self.ground = GroundSegmenter(self.config.ground)
        self.tracker = Tracker(self.config.tracks)

    def step(self, scan: Scan) -> Frame:
        """One scan in, everything known after it out."""
        ...
