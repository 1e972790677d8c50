"""The scorer: frames and truths in, metrics (name, value, unit) out."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from datmo.arrays import Bool
from datmo.messages import Frame, Relief, Truth
from eval.metrics.consistency import ConsistencyScores
from eval.metrics.detection import DetectionScores, match_detections
from eval.metrics.ghosts import ghost_detail, ghost_scores, ghosts, in_empty_space
from eval.metrics.gospa import CUTOFF
from eval.metrics.ground import label_counts, label_detail, label_scores
from eval.metrics.height import Heights, height_detail, height_scores, heights, join
from eval.metrics.history import NONE, History, Moment, moment
from eval.metrics.matching import Returns
from eval.metrics.occlusion import OcclusionScores
from eval.metrics.pairing import Paired, Pairer
from eval.metrics.ratio import spread
from eval.metrics.recovery import recovery_events
from eval.metrics.recovery_scores import recovery_detail, recovery_scores
from eval.metrics.tracking import TrackingScores
from scenarios.expect import UNITS

NO_TRACKS = "tracking.gospa_no_tracks"
StepMetrics = dict[str, float | None]


@dataclass(frozen=True)
class Metric:
    """One figure of a run; None where there was nothing to measure."""

    name: str
    value: float | None
    unit: str


Metrics = list[Metric]


class Scorer:
    """Scores scan after scan by the definitions of the scoring document.

    Args:
        blind_radius: unseen ground nearer than this does not count [m].
        filter_gate: gate of the tracker's filter (chi-square, 2 degrees of freedom), for nees.
        filter_noise: standard deviation of its position measurement [m], for nees.
    """

    def __init__(
        self, blind_radius: float = 3.0, filter_gate: float = 13.8, filter_noise: float = 0.3
    ) -> None:
        self._blind_radius = blind_radius
        self._labels: Counter[Any] = Counter()
        self._heights: list[Heights] = []
        self._detection, self._occlusion = DetectionScores(), OcclusionScores()
        self._pairer, self._tracking = Pairer(), TrackingScores()
        self._consistency = ConsistencyScores(filter_gate, filter_noise)
        self._moments: list[Moment] = []
        self._times: defaultdict[str, list[float]] = defaultdict(list)

    def add(
        self, frame: Frame, truth: Truth, relief: Relief, nis: Mapping[int, float] | None = None
    ) -> StepMetrics:
        """Take in one scan and score it alone.

        Args:
            frame: what perception made of the scan. truth: what the scan truly saw.
            relief: true ground at `grid_centres()`.
            nis: track id -> normalised innovation squared of its position in this scan (2 dimensions).

        Returns:
            ground.*, detection.* and tracking.gospa of this scan, None where there is nothing to
            measure, and beside them `tracking.gospa_no_tracks` [m], which the reward compares.
        """
        labels = label_counts(frame, truth)
        places = heights(frame, truth, relief, self._blind_radius)
        returns = Returns(frame, truth)
        matched = match_detections(frame, truth, returns)
        detection = DetectionScores()
        detection.add(frame, truth, matched)
        paired = self._pairer.pair(frame, truth, returns)

        self._labels.update(labels)
        self._heights.append(places)
        self._detection.join(detection)
        self._occlusion.add(truth, matched)
        gospa = self._tracking.add(paired)
        now = moment(frame, truth, paired, matched, _empty(frame, paired))
        self._moments.append(now)
        fed = {track: int(now.fed[row]) for track, row in now.track_row.items() if now.fed[row] != NONE}
        self._consistency.add(frame, truth, paired, fed, nis or {})
        return {
            **label_scores(labels),
            **height_scores(places),
            **detection.scores(),
            "tracking.gospa": gospa.distance,
            NO_TRACKS: CUTOFF * float(np.sqrt(len(paired.objects) / 2)),
        }

    def reward(self, step: StepMetrics) -> float:
        """The perception score of one scan, 0 to 1.

        Mean of ground.f1 x (1 - leak), the detection F1 and 1 - gospa / gospa of no tracks. Parts
        without data are left out; without any the reward is 0. A leak without data (no vehicle or
        person returned anything) counts as 0. False tracks where there is no object give 0.
        """
        parts = [_ground_part(step), _detection_part(step), _tracking_part(step)]
        known = [part for part in parts if part is not None]
        return float(np.mean(known)) if known else 0.0

    def add_times(self, times: Mapping[str, float]) -> None:
        """Take in the times of one step, `speed.*` name -> [ms]."""
        for name, value in times.items():
            self._times[name].append(float(value))

    def result(self) -> Metrics:
        """Every metric over the scans so far, in the order of `UNITS`; times are medians."""
        history = History(self._moments)
        values = {
            **label_scores(self._labels),
            **height_scores(join(self._heights)),
            **self._detection.scores(),
            **self._tracking.scores(),
            **self._occlusion.scores(),
            **recovery_scores(recovery_events(history)[0], len(history.ids())),
            **ghost_scores(ghosts(history)),
            **self._consistency.scores(),
            **{name: spread(times)["median"] for name, times in self._times.items()},
        }
        return [Metric(name, values.get(name), unit) for name, unit in UNITS.items()]

    def detail(self) -> dict[str, Any]:
        """What stands beside the metrics, JSON-able."""
        history = History(self._moments)
        events, censored = recovery_events(history)
        left = ghosts(history)
        return {
            "frames": len(self._moments),
            "ground": {**label_detail(self._labels), "height": height_detail(join(self._heights))},
            "detection": self._detection.detail(),
            "occlusion": self._occlusion.detail(),
            "tracking": self._tracking.detail(),
            "recovery": {
                **recovery_detail(events, censored),
                **ghost_detail(left, history),
                "ghosts": [asdict(g) for g in left],
            },
            "consistency": self._consistency.detail([v for e in events for v in e.nees]),
            "speed": {name: spread(times) for name, times in self._times.items()},
        }


def _empty(frame: Frame, paired: Paired) -> Bool:
    """(t,) over the reported tracks: coasting in empty space, and matched to nothing."""
    rows = np.flatnonzero(frame.tracks.confirmed())
    empty = in_empty_space(frame, rows)
    lone: Bool = empty & ~np.isin(rows, paired.tracks[paired.pairs[:, 1]])
    return lone


def _ground_part(step: StepMetrics) -> float | None:
    f1 = step.get("ground.f1")
    return None if f1 is None else f1 * (1 - (step.get("ground.leak") or 0.0))


def _detection_part(step: StepMetrics) -> float | None:
    precision, recall = step.get("detection.precision"), step.get("detection.recall")
    if precision is None and recall is None:
        return None
    if not precision or not recall:
        return 0.0
    return 2 * precision * recall / (precision + recall)


def _tracking_part(step: StepMetrics) -> float | None:
    gospa, nothing = step.get("tracking.gospa"), step.get(NO_TRACKS)
    if gospa is None or nothing is None or (gospa == 0 and nothing == 0):
        return None
    return max(0.0, 1 - gospa / nothing) if nothing else 0.0
