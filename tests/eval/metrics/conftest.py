"""Hand-made messages for the judge's tests."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from datmo.arrays import Array
from datmo.messages import (
    Boxes,
    Clusters,
    Frame,
    Ground,
    Kind,
    LostRays,
    Plane,
    Relief,
    Scan,
    Tracks,
    Truth,
    Visibility,
)

SIZES = {Kind.CAR: (4.0, 1.8, 1.5), Kind.TRUCK: (10.0, 2.5, 3.0), Kind.PEDESTRIAN: (0.6, 0.6, 1.7)}


def make_boxes(
    xy: Any, *, kind: Any = Kind.CAR, ids: Any = None, yaw: Any = 0.0, velocity: Any = (10.0, 0.0)
) -> Boxes:
    """Boxes at bird's-eye places; ids 0, 1, ... unless told."""
    xy = np.asarray(xy, float).reshape(-1, 2)
    k = len(xy)
    kind = np.broadcast_to(kind, k)
    size = np.array([SIZES[Kind(i)] for i in kind], float).reshape(k, 3)
    return Boxes(
        center=np.column_stack([xy, np.zeros(k)]),
        size=size,
        yaw=np.broadcast_to(yaw, k),
        velocity=np.broadcast_to(velocity, (k, 2)),
        id=np.arange(k) if ids is None else np.asarray(ids),
        kind=kind,
    )


def make_tracks(
    xy: Any, *, ids: Any = None, status: Any = 5, dynamic: Any = True, cov: Any = None, **rest: Any
) -> Tracks:
    """Tracks at bird's-eye places; dynamic and updated unless told."""
    boxes = make_boxes(xy, ids=ids, **rest)
    k = len(boxes)
    return Tracks(
        boxes,
        cov=np.broadcast_to(np.eye(5) if cov is None else cov, (k, 5, 5)),
        status=np.broadcast_to(status, k),
        is_dynamic=np.broadcast_to(dynamic, k),
    )


def make_truth(
    boxes: Boxes,
    *,
    stamp: float = 0.0,
    visibility: Any = Visibility.VISIBLE,
    returns: Any = 50,
    **points: Array,
) -> Truth:
    """A truth; what is said of points defaults to "terrain"."""
    k = len(boxes)
    n = len(next(iter(points.values()))) if points else 0
    lost = LostRays(*[np.zeros(0)] * 6)
    shown = np.broadcast_to(visibility, k)
    per_point = {
        "actor": np.full(n, -1),
        "thing": np.full(n, -1),
        "kind": np.full(n, Kind.ROAD),
        "is_ground": np.ones(n, bool),
        "height": np.full(n, -1.73),
        "normal": np.tile([0.0, 0.0, 1.0], (n, 1)),
        **points,
    }
    return Truth(
        boxes=boxes,
        stamp=stamp,
        T_world_actor=np.tile(np.eye(4), (k, 1, 1)),
        solo=np.where(shown == Visibility.OUT_OF_RANGE, 0, 100),
        visible=np.where(shown > Visibility.HIDDEN, 100, 0),
        returns=np.broadcast_to(returns, k),
        lost_to=np.zeros((k, k + 2)),
        visibility=shown,
        lost=lost,
        **per_point,  # type: ignore[arg-type]
    )


def make_frame(
    *,
    boxes: Boxes | None = None,
    tracks: Tracks | None = None,
    points: Any = None,
    is_ground: Any = None,
    surface: Any = None,
    stamp: float = 0.0,
) -> Frame:
    """A frame; no points, boxes or tracks unless told."""
    points = np.zeros((0, 3)) if points is None else np.asarray(points, float)
    n = len(points)
    called = np.ones(n, bool) if is_ground is None else is_ground
    return Frame(
        scan=Scan(points, stamp=stamp),
        ground=Ground(called, np.full(n, -1.73), np.full(n, 0.1), surface or Plane()),
        clusters=Clusters(np.full(n, -1)),
        boxes=Boxes.empty() if boxes is None else boxes,
        tracks=Tracks.empty(stamp) if tracks is None else tracks,
    )


def make_relief(xy: Any = (), height: Any = -1.73, exposed: Any = True, kind: Any = Kind.ROAD) -> Relief:
    """True ground at places."""
    xy = np.asarray(xy, float).reshape(-1, 2)
    wide = [np.broadcast_to(v, len(xy)) for v in (height, exposed, kind)]
    return Relief(xy, *wide)


def lane(n: int, start: Sequence[float], speed: float, period: float = 0.1) -> Array:
    """n places (n, 2) of something that drives along +x."""
    return np.asarray(start, float) + np.arange(n)[:, None] * period * np.array([speed, 0.0])


@pytest.fixture(scope="session")
def make() -> SimpleNamespace:
    """The makers of messages."""
    return SimpleNamespace(
        boxes=make_boxes,
        tracks=make_tracks,
        truth=make_truth,
        frame=make_frame,
        relief=make_relief,
        lane=lane,
    )
