"""CLEAR (mota, motp, switches, fragmentations), HOTA and identity scores of a run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from datmo.arrays import F64, I64
from eval.metrics.gospa import Gospa, gospa
from eval.metrics.pairing import EPS, MATCHED, Paired
from eval.metrics.ratio import mean, ratio, spread

ALPHAS = np.arange(0.05, 0.99, 0.05)
Similarities = Sequence[tuple[I64, I64, F64]]


class Clear:
    """CLEAR counts over scans in order (Bernardin and Stiefelhagen 2008).

    A switch is a change of the track id matched to an object since its last match, however long
    ago. A fragmentation is a match after scans in which the object counted but was missed; scans
    in which the object was hidden interrupt nothing.
    """

    def __init__(self) -> None:
        self.matched = self.false = self.missed = 0
        self.switches = self.fragmentations = self.ignored = self.called_static = 0
        self.distances: list[float] = []
        self._partner: dict[int, int] = {}
        self._interrupted: set[int] = set()

    def add(self, paired: Paired) -> None:
        """Take in one scan."""
        rows, columns = paired.pairs.T
        self.matched += len(rows)
        self.missed += len(paired.objects) - len(rows)
        self.false += len(paired.tracks) - len(rows)
        self.ignored += paired.ignored
        self.called_static += paired.called_static
        self.distances += paired.distance[rows, columns].tolist()
        partner = paired.partner
        for actor in paired.object_id.tolist():
            if actor not in partner:
                self._interrupted |= {actor} & self._partner.keys()
                continue
            self.switches += self._partner.get(actor, partner[actor]) != partner[actor]
            self.fragmentations += actor in self._interrupted
            self._interrupted.discard(actor)
            self._partner[actor] = partner[actor]

    def scores(self) -> dict[str, float | None]:
        """The named scores; all None when there was no object."""
        objects = self.matched + self.missed
        errors = self.missed + self.false + self.switches
        return {
            "tracking.mota": None if not objects else 1 - errors / objects,
            "tracking.motp": mean(self.distances),
            "tracking.id_switches": float(self.switches) if objects else None,
            "tracking.fragmentations": float(self.fragmentations) if objects else None,
        }

    def detail(self) -> dict[str, Any]:
        """What stands beside: the counts and the spread of the distances [m]."""
        return {
            "matched": self.matched,
            "missed": self.missed,
            "missed_called_static": self.called_static,
            "false": self.false,
            "ignored": self.ignored,
            "distance": spread(self.distances),
        }


def _index(frames: Similarities) -> tuple[list[tuple[I64, I64, F64]], int, int]:
    """The same scans with ids numbered from 0, and how many of each there are."""
    objects = np.unique(np.concatenate([f[0] for f in frames] or [np.zeros(0, np.int64)]))
    tracks = np.unique(np.concatenate([f[1] for f in frames] or [np.zeros(0, np.int64)]))
    numbered = [(np.searchsorted(objects, a), np.searchsorted(tracks, b), s) for a, b, s in frames]
    return numbered, len(objects), len(tracks)


def hota(frames: Similarities) -> dict[str, float | None]:
    """HOTA, its detection and association parts and localisation (Luiten 2021).

    Args:
        frames: per scan object ids (g,), track ids (t,), similarity (g, t).

    Returns:
        hota, deta, assa, loca: means over the 19 thresholds 0.05 .. 0.95; None when there is
        neither object nor track.
    """
    scans, g, t = _index(frames)
    if g + t == 0:
        return dict.fromkeys(("hota", "deta", "assa", "loca"))
    alignment, objects, tracks = _alignment(scans, g, t)
    found: list[tuple[I64, I64, F64]] = []
    for a, b, similarity in scans:
        row, column = linear_sum_assignment(-alignment[np.ix_(a, b)] * similarity)
        found.append((a[row], b[column], similarity[row, column]))
    object_, track, shared = (np.concatenate(column) for column in zip(*found, strict=True))
    hits, assa, overlap = np.zeros((3, len(ALPHAS)))
    for i, alpha in enumerate(ALPHAS):
        kept = shared >= alpha - EPS
        pair, together = np.unique(object_[kept] * max(t, 1) + track[kept], return_counts=True)
        union = objects[pair // max(t, 1)] + tracks[pair % max(t, 1)] - together
        hits[i], overlap[i] = kept.sum(), shared[kept].sum()
        assa[i] = np.sum(together**2 / union) / max(1, hits[i])
    deta = hits / np.maximum(1, objects.sum() + tracks.sum() - hits)
    loca = np.maximum(1e-10, overlap) / np.maximum(1e-10, hits)
    return {
        "hota": float(np.mean(np.sqrt(deta * assa))),
        "deta": float(np.mean(deta)),
        "assa": float(np.mean(assa)),
        "loca": float(np.mean(loca)),
    }


def _alignment(scans: Similarities, g: int, t: int) -> tuple[F64, F64, F64]:
    """How well each object and track go together over the run (g, t); scans of each (g,), (t,)."""
    shared, objects, tracks = np.zeros((g, t)), np.zeros(g), np.zeros(t)
    for a, b, similarity in scans:
        union = similarity.sum(0)[None, :] + similarity.sum(1)[:, None] - similarity
        part = np.divide(similarity, union, out=np.zeros_like(similarity), where=union > EPS)
        shared[np.ix_(a, b)] += part
        objects[a] += 1
        tracks[b] += 1
    return shared / np.maximum(objects[:, None] + tracks - shared, EPS), objects, tracks


def idf1(frames: Similarities) -> float | None:
    """Identity F1 at similarity >= 0.5 (Ristani 2016); None without objects and tracks."""
    scans, g, t = _index(frames)
    together = np.zeros((g, t))
    total = 0
    for a, b, similarity in scans:
        together[np.ix_(a, b)] += similarity >= MATCHED - EPS
        total += len(a) + len(b)
    hits = together[linear_sum_assignment(-together)].sum()
    return ratio(2 * hits, total)


class TrackingScores:
    """All tracking scores over scans in order."""

    def __init__(self) -> None:
        self._clear = Clear()
        self._frames: list[tuple[I64, I64, F64]] = []
        self._gospa: list[Gospa] = []

    def add(self, paired: Paired) -> Gospa:
        """Take in one scan; returns its GOSPA."""
        self._clear.add(paired)
        self._frames.append((paired.object_id, paired.track_id, paired.similarity))
        self._gospa.append(gospa(paired.distance, paired.allowed))
        return self._gospa[-1]

    def scores(self) -> dict[str, float | None]:
        """The named scores."""
        return {
            "tracking.hota": hota(self._frames)["hota"],
            **self._clear.scores(),
            "tracking.idf1": idf1(self._frames),
            "tracking.gospa": mean([g.distance for g in self._gospa]),
        }

    def detail(self) -> dict[str, Any]:
        """What stands beside: the parts of HOTA, CLEAR and GOSPA [m²]."""
        parts = ("localisation", "missed", "false")
        return {
            "hota": hota(self._frames),
            "clear": self._clear.detail(),
            "gospa": spread([g.distance for g in self._gospa]),
            "gospa_parts": {name: mean([getattr(g, name) for g in self._gospa]) for name in parts},
        }
