"""The boxes of one scan as the tracker takes them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64, Array, Bool
from datmo.messages import Boxes
from datmo.tracks.config import TrackerConfig
from datmo.tracks.measurement.trust import noise_factor, trust


@dataclass(frozen=True)
class Measured:
    """What was seen of objects, k rows.

    Attributes:
        boxes: the parts that were seen [world].
        expected: (k, 2) extent of the whole along the axes of these boxes, as the detector has it [m].
        trust: (k,) probability to be real. factor: (k,) how many times the usual deviation each has.
    """

    boxes: Boxes
    expected: F64
    trust: F64
    factor: F64

    def __len__(self) -> int:
        return len(self.boxes)

    def select(self, rows: Array) -> Measured:
        """Those of `rows` (indices or a mask)."""
        return Measured(self.boxes.select(rows), self.expected[rows], self.trust[rows], self.factor[rows])


def measured(boxes: Boxes, logits: bool, config: TrackerConfig) -> Measured:
    """The boxes of one scan that are likely enough to be real; `logits`: whether their scores are."""
    trusted = trust(boxes.score, logits, config)
    made = Measured(boxes.visible(), boxes.whole_extent(), trusted, noise_factor(trusted, config))
    kept = trusted >= config.least_trust
    return made if kept.all() else made.select(kept)


def sound(boxes: Boxes) -> Bool:
    """(k,) whether all values are finite and all sides positive, of what was seen and of the whole."""
    seen = boxes.visible()
    sides = np.column_stack([seen.size, boxes.whole_extent()])
    numbers = np.column_stack([seen.center, seen.yaw, seen.score, sides])
    return np.asarray(np.isfinite(numbers).all(axis=1) & (sides > 0).all(axis=1))
