"""Which stage lost an object: its returns followed through ground, clusters, rules and boxes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from datmo.arrays import I64, U8, Bool
from datmo.messages import Frame, Truth
from eval.metrics.detection import Matched

LEAST_RETURNS = 10
"""An object with fewer is not judged."""
PART, PART_RETURNS = 0.2, 5
"""A second cluster counts from this share of an object's clustered returns, and this many, on."""
MOST = 0.5


class Stage(IntEnum):
    """Where an object was lost."""

    NONE = 0
    """It was found."""
    GROUND = 1
    """Most of its returns were called ground."""
    CLUSTERS = 2
    """No cluster holds five of them, or the one that does belongs to another or to things."""
    RULES = 3
    """Its cluster was refused."""
    BOXES = 4
    """Its cluster has a box, which lies too far off."""


@dataclass(frozen=True)
class Diagnosis:
    """What became of the k objects of one scan.

    Attributes:
        judged: (k,) those with at least ten returns.
        main: (k,) the cluster that holds most of the returns, -1 none.
        split: (k,) whether another cluster holds a part of them.
        merged: (k,) whether the main cluster is another judged object's too, or mostly things'.
        stage: (k,) `Stage` that lost it.
    """

    judged: Bool
    main: I64
    split: Bool
    merged: Bool
    stage: U8


def diagnose(frame: Frame, truth: Truth, matched: Matched) -> Diagnosis:
    """Follow the returns of every object through the stages.

    Args:
        frame: what perception made of the scan. truth: what the scan truly saw.
        matched: the verdict on its detections.
    """
    k, labels = len(truth.boxes), frame.clusters
    judged = truth.returns >= LEAST_RETURNS
    # Returns of each object by cluster, the last column those in none; row k: things.
    held = np.zeros((k + 1, max(labels.count, 1) + 1), np.int64)
    rows = np.flatnonzero((truth.actor >= 0) | (truth.thing >= 0))
    owner = np.where(truth.actor[rows] >= 0, truth.actor[rows], k)
    np.add.at(held, (owner, labels.label[rows]), 1)
    mine, things = held[:k, :-1], held[k, :-1]

    most = mine.max(1)
    main = np.where(most > 0, mine.argmax(1), -1)
    others = mine.copy()
    others[np.arange(k), main] = 0  # -1 writes into a column that an object without a cluster has empty
    second = others.max(1)
    split = judged & (second >= PART_RETURNS) & (second >= PART * mine.sum(1))
    merged = judged & _shared(main, most, judged, things)
    return Diagnosis(judged, main, split, merged, _stages(frame, truth, matched, main, most, merged))


def _shared(main: I64, most: I64, judged: Bool, things: I64) -> Bool:
    """Whether the main cluster of each object is that of another judged one, or mostly things'."""
    sure = judged & (most >= PART_RETURNS)
    count = np.bincount(main[sure], minlength=len(things))
    return np.array(
        [c >= 0 and bool(count[c] - sure[i] > 0 or things[c] > most[i]) for i, c in enumerate(main.tolist())],
        bool,
    ).reshape(len(main))


def _stages(frame: Frame, truth: Truth, matched: Matched, main: I64, most: I64, merged: Bool) -> U8:
    """The first stage, in their order, that explains why an object was not found."""
    k = len(main)
    own = truth.actor >= 0
    ground = np.bincount(truth.actor[own & frame.ground.is_ground], minlength=k)[:k]
    refused = np.array([f"cluster {c}" in frame.notes for c in main.tolist()], bool).reshape(k)
    lost = ~matched.found
    cases = (
        ~lost,
        ground > MOST * np.maximum(truth.returns, 1),
        (most < PART_RETURNS) | merged,
        refused,
    )
    return np.select(cases, (Stage.NONE, Stage.GROUND, Stage.CLUSTERS, Stage.RULES), Stage.BOXES).astype(
        np.uint8
    )
