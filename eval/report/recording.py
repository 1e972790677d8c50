"""Recording: what a report needs of a run, frame by frame, without keeping its clouds."""

from __future__ import annotations

import io
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from PIL import Image
from scipy.optimize import linear_sum_assignment

from datmo.arrays import F64, I64, U8
from datmo.messages import VEHICLES, Boxes, Frame, Truth, is_any
from eval.report.heights import HeightMap
from eval.score import Metric
from eval.view import BirdsEye
from scenarios.spec import Scenario

PICTURES = 36
QUALITY = 82
KEPT = 1000.0


@dataclass(frozen=True)
class Moment:
    """One frame, small: the objects, what is seen of each, and the track on each.

    Attributes:
        stamp: [s]. id (k,), kind (k,), visibility (k,) of the true objects.
        track: (k,) id of the confirmed track matched to each, -1 none.
        milliseconds: of each stage.
    """

    stamp: float
    id: I64
    kind: U8
    visibility: U8
    track: I64
    milliseconds: dict[str, float]


@dataclass
class Recording:
    """A run as it is played. `add` takes each frame in; `finish` takes the scores.

    Pictures are taken every `every` frames and thinned out to at most `PICTURES`, so memory and
    report stay small however long the run is.
    """

    scenario: Scenario
    seed: int
    frames: int
    ground: str | None = None
    moments: list[Moment] = field(default_factory=list)
    pictures: list[tuple[float, bytes]] = field(default_factory=list)
    heights: HeightMap = field(default_factory=HeightMap)
    metrics: list[Metric] = field(default_factory=list)
    detail: dict[str, Any] = field(default_factory=dict)
    last: U8 | None = None
    _view: BirdsEye = field(default_factory=BirdsEye)
    _partner: dict[int, int] = field(default_factory=dict)

    @property
    def whole(self) -> bool:
        """Whether the scenario was to be played to its end."""
        return self.frames >= self.scenario.scans

    @property
    def every(self) -> int:
        """Frames between two pictures."""
        return max(1, -(-self.frames // PICTURES))

    def add(self, frame: Frame, truth: Truth, milliseconds: dict[str, float]) -> None:
        """Take in one frame with its truth and the times of all stages [ms]."""
        self._view.follow(frame)
        self.heights.add(frame, truth)
        if len(self.moments) % self.every == 0 or len(self.moments) + 1 == self.frames:
            self.last = self._view.draw(frame, truth)
            self.pictures.append((truth.stamp, encode(self.last)))
        track = self._match(frame, truth.boxes)
        boxes = truth.boxes
        moment = Moment(truth.stamp, boxes.id, boxes.kind, truth.visibility, track, milliseconds)
        self.moments.append(moment)

    def _match(self, frame: Frame, boxes: Boxes) -> I64:
        """Confirmed track (k,) on each object, hidden ones too; a pair goes on while it may."""
        rows = np.flatnonzero(frame.tracks.confirmed())
        track_id, place = frame.tracks.boxes.id[rows], frame.tracks.boxes.center[rows]
        gate = np.where(is_any(boxes.kind, VEHICLES), 2.0, 1.0)[:, None]
        distance: F64 = np.hypot(*(boxes.center[:, None, k] - place[None, :, k] for k in (0, 1)))
        partner = np.array([self._partner.get(int(i), -1) for i in boxes.id], np.int64)
        worth = np.where(distance <= gate, 3 - distance + KEPT * (partner[:, None] == track_id), 0.0)
        row, column = linear_sum_assignment(-worth)
        track = np.full(len(boxes), -1, np.int64)
        good = worth[row, column] > 0
        track[row[good]] = track_id[column[good]]
        self._partner |= {int(i): int(t) for i, t in zip(boxes.id, track, strict=True) if t >= 0}
        return track


def encode(image: U8, form: str = "JPEG") -> bytes:
    """An image (h, w, 3) as the bytes of a JPEG or PNG file."""
    buffer = io.BytesIO()
    options = {"quality": QUALITY, "subsampling": 0} if form == "JPEG" else {"optimize": True}
    Image.fromarray(image).save(buffer, form, **options)
    return buffer.getvalue()
