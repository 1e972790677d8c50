"""Which tracks and which objects of a scan count, and which track is matched to which object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from datmo.arrays import F64, I64, Bool
from datmo.messages import Frame, Truth, Visibility
from eval.metrics.matching import Returns, distances, gates, reaches

MOVING = 0.5
MATCHED = 0.5
CONTINUED = 1000.0
NOBODY = int(np.iinfo(np.int64).min)
EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Paired:
    """One scan, ready for the tracking metrics.

    Attributes:
        objects: (g,) rows in `Truth.boxes` of the actors that are neither hidden nor out of range.
        tracks: (t,) rows in `Frame.tracks` that are reported and not to be ignored.
        object_id: (g,). track_id: (t,).
        distance: (g, t) bird's-eye [m].
        allowed: (g, t) False where a moving actor meets a track that is called static.
        similarity: (g, t) max(0, 1 - distance / d0), 0 where not allowed.
        pairs: (p, 2) matched (object, track), indices into the g objects and t tracks.
        ignored: number of reported tracks that do not count.
        called_static: number of moving objects missed with a track called static in their gate.
    """

    objects: I64
    tracks: I64
    object_id: I64
    track_id: I64
    distance: F64
    allowed: Bool
    similarity: F64
    pairs: I64
    ignored: int
    called_static: int

    @property
    def partner(self) -> dict[int, int]:
        """Track id matched to each matched object id."""
        ids = zip(self.object_id[self.pairs[:, 0]], self.track_id[self.pairs[:, 1]], strict=True)
        return {int(a): int(b) for a, b in ids}


class Pairer:
    """Matches scan after scan; a pair of the last scan goes on while it may (CLEAR).

    Actors that are neither hidden nor out of range are matched first, at d <= d0 / 2. A reported
    track that is left over is ignored within the gate of an actor that is hidden or out of range
    (the object is there), when it is called static and lies within the gate of a moving actor that
    is missed (which counts once, as the miss), or when it is called static and stands on a thing. A track
    whose box holds no obstacle return keeps the last answer to whether it stands on a thing.
    """

    def __init__(self) -> None:
        self._partner: dict[int, int] = {}
        self._on_thing: dict[int, bool] = {}

    def pair(self, frame: Frame, truth: Truth, returns: Returns) -> Paired:
        """Pair one scan; scans must come in order."""
        tracks, boxes = frame.tracks, truth.boxes
        valid = truth.visibility > Visibility.HIDDEN
        objects, rows = np.flatnonzero(valid), np.flatnonzero(tracks.confirmed())
        moving = np.hypot(boxes.velocity[:, 0], boxes.velocity[:, 1]) > MOVING
        dynamic = tracks.is_dynamic[rows]

        every = distances(boxes.center, tracks.boxes.center[rows])
        distance = every[objects]
        allowed = dynamic | ~moving[objects, None]
        nearness = 1 - distance / reaches(boxes.kind[objects])[:, None]
        similarity = np.where(allowed, np.maximum(0, nearness), 0.0)
        pairs = self._match(boxes.id[objects], tracks.boxes.id[rows], similarity)

        left = np.ones(len(rows), bool)
        left[pairs[:, 1]] = False
        missed = valid & moving
        missed[objects[pairs[:, 0]]] = False
        within = every <= gates(boxes)[:, None]
        called_static = within & missed[:, None] & left & ~dynamic
        ignored = (left & within[~valid].any(0)) | called_static.any(0)
        static = np.flatnonzero(left & ~ignored & ~dynamic)
        ignored[static] = self._stand_on_things(frame, rows[static], returns)

        kept = np.flatnonzero(~ignored)
        paired = Paired(
            objects=objects,
            tracks=rows[kept],
            object_id=boxes.id[objects],
            track_id=tracks.boxes.id[rows[kept]],
            distance=distance[:, kept],
            allowed=allowed[:, kept],
            similarity=similarity[:, kept],
            pairs=np.column_stack([pairs[:, 0], np.searchsorted(kept, pairs[:, 1])]),
            ignored=len(rows) - len(kept),
            called_static=int(called_static.any(1).sum()),
        )
        self._partner = paired.partner
        return paired

    def _match(self, object_id: I64, track_id: I64, similarity: F64) -> I64:
        """Pairs (p, 2) of greatest total similarity, those of the last scan kept before all."""
        last = np.array([self._partner.get(int(i), NOBODY) for i in object_id], np.int64)
        near = similarity >= MATCHED - EPS
        worth = np.where(near, similarity + CONTINUED * (last[:, None] == track_id), 0.0)
        row, column = linear_sum_assignment(-worth)
        kept = near[row, column]
        return np.stack([row[kept], column[kept]], 1).astype(np.int64)

    def _stand_on_things(self, frame: Frame, rows: I64, returns: Returns) -> Bool:
        on_thing, holds = returns.on_things(frame.tracks.boxes.select(rows))
        answers = np.zeros(len(rows), bool)
        for i, track in enumerate(frame.tracks.boxes.id[rows].tolist()):
            if holds[i]:
                self._on_thing[track] = bool(on_thing[i])
            answers[i] = self._on_thing.get(track, False)
        return answers
