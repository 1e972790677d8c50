"""Clusters, Boxes and Tracks: what stands on the ground."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from datmo.arrays import F32, F64, I32, I64, U8, Array, Bool
from datmo.errors import MessageError
from datmo.geometry import half_turn
from datmo.messages.base import Message, Status

EDGE = 0.01  # [m] least seen side: points on one line are as wide as their noise


@dataclass(frozen=True, eq=False)
class Clusters(Message):
    """Which cluster each point of a scan belongs to.

    Attributes:
        label: (n,) cluster of each point, -1 none; labels are 0 .. count - 1.
        count: number of clusters.
    """

    label: I32
    count: int = 0

    def __post_init__(self) -> None:
        self._set("label", (None,), np.int32)
        top = int(self.label.max(initial=-1))
        if top >= self.count:
            raise MessageError(f"Clusters.label reaches {top}; count is {self.count}; labels lie below count")


@dataclass(frozen=True, eq=False)
class Boxes(Message):
    """Upright boxes; one type serves detections, tracks and truth.

    `Boxes(center=c, size=s, yaw=y)` suffices.

    Attributes:
        center: (k, 3) middle of the box [m, world].
        size: (k, 3) length, width, height [m], length along the yaw.
        yaw: (k,) heading of the length axis [rad, world, from +x].
        velocity: (k, 2) [m/s, world], NaN unknown.
        score: (k,).
        id: (k,) -1 none.
        kind: (k,) `Kind`.
    """

    center: F64
    size: F64
    yaw: F64
    velocity: F64 = None  # type: ignore[assignment]
    score: F32 = None  # type: ignore[assignment]
    id: I64 = None  # type: ignore[assignment]
    kind: U8 = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        self._set("center", (None, 3), np.float64)
        k = len(self.center)
        self._set("size", (k, 3), np.float64)
        self._set("yaw", (k,), np.float64)
        self._set("velocity", (k, 2), np.float64, np.nan)
        self._set("score", (k,), np.float32, 1)
        self._set("id", (k,), np.int64, -1)
        self._set("kind", (k,), np.uint8, 0)

    def __len__(self) -> int:
        return len(self.center)

    @classmethod
    def empty(cls) -> Self:
        """No boxes."""
        return cls(center=np.zeros((0, 3)), size=np.zeros((0, 3)), yaw=np.zeros(0))

    def select(self, rows: Array) -> Self:
        """The boxes of `rows` (indices or a mask), in that order."""
        return type(self)(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})

    def visible(self) -> Boxes:
        """What of the boxes was seen; of those that are no detections, all."""
        return self

    def whole_extent(self) -> F64:
        """(k, 2) length and width of the whole, along the axes of what `visible` gives [m]."""
        return self.size[:, :2]


@dataclass(frozen=True, eq=False)
class Detections(Boxes):
    """Boxes found in one scan: whole ones, and how much of each was seen.

    Attributes:
        cov: (k, 3, 3) over x, y [m, world] and yaw [rad].
        seen: (k, 4) from where to where along the length, and along the width, each box was seen, about its
            centre [m].
        shape: (k,) `datmo.boxes.Shape` of the outline.
        cluster: (k,) label of the cluster it was made of, -1 none.
    """

    cov: F64 = None  # type: ignore[assignment]
    seen: F64 = None  # type: ignore[assignment]
    shape: U8 = None  # type: ignore[assignment]
    cluster: I64 = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        super().__post_init__()
        k = len(self)
        self._set("cov", (k, 3, 3), np.float64, np.eye(3))
        if self.seen is None:
            object.__setattr__(self, "seen", self.size[:, [0, 0, 1, 1]] / 2 * np.array([-1, 1, -1, 1]))
        self._set("seen", (k, 4), np.float64)
        self._set("shape", (k,), np.uint8, 0)
        self._set("cluster", (k,), np.int64, -1)

    def visible(self) -> Boxes:
        """The seen parts alone, length >= width > 0, yaw in [-pi/2, pi/2)."""
        along, across = (self.seen[:, 1::2] - self.seen[:, ::2]).T
        x, y = (self.seen[:, 0] + self.seen[:, 1]) / 2, (self.seen[:, 2] + self.seen[:, 3]) / 2
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        center, size = self.center.copy(), self.size.copy()
        center[:, 0] += c * x - s * y
        center[:, 1] += s * x + c * y
        size[:, 0], size[:, 1] = np.maximum(along, across), np.maximum(np.minimum(along, across), EDGE)
        yaw = np.where(along >= across, self.yaw, self.yaw + np.pi / 2)
        return Boxes(center, size, half_turn(yaw), self.velocity, self.score, self.id, self.kind)

    def whole_extent(self) -> F64:
        """See `Boxes`: where what was seen is longer across, the sides change places."""
        along, across = (self.seen[:, 1::2] - self.seen[:, ::2]).T
        return np.where((along >= across)[:, None], self.size[:, :2], self.size[:, 1::-1])


@dataclass(frozen=True, eq=False)
class Tracks(Message):
    """The tracker's state after a scan.

    Attributes:
        boxes: k boxes; `boxes.id` is the track id, `boxes.velocity` the estimate.
        stamp: [s].
        cov: (k, 5, 5) over x, y [m, world], yaw [rad], speed [m/s], yaw rate [rad/s].
        mode_prob: (k, m) probability of each motion model.
        status: (k,) Table 4.1; >= 5 is a confirmed track.
        is_dynamic: (k,) bool.
    """

    boxes: Boxes
    stamp: float = 0.0
    cov: F64 = None  # type: ignore[assignment]
    mode_prob: F64 = None  # type: ignore[assignment]
    status: U8 = None  # type: ignore[assignment]
    is_dynamic: Bool = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        k = len(self.boxes)
        object.__setattr__(self, "stamp", float(self.stamp))
        self._set("cov", (k, 5, 5), np.float64, np.eye(5))
        if self.mode_prob is None:
            object.__setattr__(self, "mode_prob", np.ones((k, 1)))
        self._set("mode_prob", (k, None), np.float64)
        self._set("status", (k,), np.uint8, int(Status.TRACKING))
        self._set("is_dynamic", (k,), np.bool_, False)

    def __len__(self) -> int:
        return len(self.boxes)

    @classmethod
    def empty(cls, stamp: float = 0.0) -> Tracks:
        """No tracks."""
        return cls(boxes=Boxes.empty(), stamp=stamp)

    def confirmed(self) -> Bool:
        """(k,) whether each track is reported: status >= 5."""
        return self.status >= Status.TRACKING
