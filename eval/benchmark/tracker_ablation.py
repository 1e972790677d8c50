"""What each idea of the tracker brings: each switched off, in turn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from datmo.tracks import TrackerConfig
from eval.benchmark.kitti_tracks import Drive
from eval.benchmark.tracker_real import RealScores, score_real
from eval.benchmark.tracker_rivals import Ours

BOTH: Mapping[str, Mapping[str, Any]] = {
    "cv alone": {"models": ("cv",)},
    "ctrv alone": {"models": ("ctrv",)},
    "rm alone": {"models": ("rm",)},
    "cv and ctrv": {"models": ("cv", "ctrv")},
    "modes move while unseen": {"freeze_unseen": False},
    "textbook mixing": {"mix_yaw_rate": True, "freeze_unseen": False},
    "no yaw measured": {"use_yaw": False},
    "size and heading weigh nothing": {"weigh_shape": False},
    "clutter by volume": {"clutter": "nonparametric"},
    "no second stage": {"recall": False},
    "each track by itself": {"association": "pda"},
    "nearest neighbour": {"association": "gnn"},
    "existence, not time": {"association": "jipda"},
    "crowds cut to two boxes": {"max_frontier": 2},
}
"""Fields of `TrackerConfig` that switch one idea off, by its name."""
GIVEN: Mapping[str, Mapping[str, Any]] = {
    "hits alone confirm": {"confirm_trust": 1.0},
    "any box starts a track": {"birth_trust": 0.0, "least_trust": 0.0},
    "scores ignored": {"scores": "ignored"},
    "all boxes equally exact": {"doubt_noise": 0.0},
    "one miss is death": {"max_coast": 0.1},
    "life of half a second": {"max_coast": 0.5},
    "life of a second": {"max_coast": 1.0},
}
"""The same, of what tells only with scores, or where no rays are given."""
RAYS: Mapping[str, Mapping[str, Any]] = {
    "hidden or not, 0.8 s of life": {"max_hidden": 0.8},
    "hidden or not, 3 s of life": {"max_missed": 3.0, "max_hidden": 3.0},
    "free space is no evidence": {"empty_weight": 0.0},
    "boxes as they are": {"correct_ends": False},
    "nothing learned from not being seen": {"hold_back": False},
}
"""The same, of what needs the rays of the scan."""
ABLATIONS: Mapping[str, Mapping[str, Any]] = {**BOTH, **GIVEN}
SIMULATED: Mapping[str, Mapping[str, Any]] = {
    **BOTH,
    "existence, not time": {"association": "jipda", "visible_floor": 0.02},
    **RAYS,
}
WHOLE = "all"


def ablate(
    base: TrackerConfig,
    played: Sequence[Drive],
    changes: Mapping[str, Mapping[str, Any]] = ABLATIONS,
    coasting: bool = True,
) -> dict[str, RealScores]:
    """Figures over all sequences of the tracker as it is, under "all", and then with each change.

    Raises:
        ConfigError: TrackEval is not installed, or no sequence is given.
    """
    configs = {WHOLE: base}
    for name, fields in changes.items():
        configs[name] = TrackerConfig(**(base.model_dump() | dict(fields)))
    scores = score_real({name: Ours(config, coasting) for name, config in configs.items()}, played)
    return {name: each["all"] for name, each in scores.items()}
