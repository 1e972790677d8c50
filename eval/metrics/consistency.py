"""Consistency: does the filter's covariance speak the truth about its error? Target 1."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from datmo.arrays import F64, I64, Array
from datmo.geometry import wrap_angle
from datmo.messages import Frame, Truth
from eval.metrics.matching import assign
from eval.metrics.pairing import Paired
from eval.metrics.ratio import mean, spread

NIS_DIMENSION = 2


def nees(error: F64, cov: F64) -> F64:
    """Normalised squared errors (n,) divided by the dimension d; NaN where cov is not positive.

    Args:
        error: (n, d). cov: (n, d, d).
    """
    values = np.full(len(error), np.nan)
    eigenvalue = np.linalg.eigvalsh(cov) if len(cov) else np.zeros((0, 1))
    good = eigenvalue[:, 0] > 0
    solved = np.linalg.solve(cov[good], error[good][..., None])[..., 0]
    values[good] = np.sum(error[good] * solved, axis=1) / error.shape[1]
    return values


class ConsistencyScores:
    """NEES of matched tracks and NIS on true measurements.

    A pair counts when it is matched (d <= d0 / 2), or when the object lies within the gate of the
    filter itself, eᵀ (P + R)⁻¹ e <= `gate`, R = `noise`² I, so that the gate cuts no error off.
    The full state beside it is (x, y, yaw, speed), with (yaw, v) and (yaw + π, -v) taken as one;
    the messages carry no yaw rate.

    Args:
        gate: of the filter, chi-square with 2 degrees of freedom.
        noise: standard deviation of its position measurement [m].
    """

    def __init__(self, gate: float = 13.8, noise: float = 0.3) -> None:
        self._gate, self._noise = gate, noise
        self._nees: list[float] = []
        self._full: list[float] = []
        self._nis: list[float] = []

    def add(
        self, frame: Frame, truth: Truth, paired: Paired, fed: Mapping[int, int], nis: Mapping[int, float]
    ) -> None:
        """Take in one scan.

        Args:
            fed: track id -> id of the object whose measurement updated it.
            nis: track id -> normalised innovation squared of its position [2 dimensions].
        """
        i, j = self._pairs(frame, truth, paired)
        rows, columns = paired.objects[i], paired.tracks[j]
        true, found = truth.boxes.select(rows), frame.tracks.boxes.select(columns)
        cov = frame.tracks.cov[columns]
        place = (found.center - true.center)[:, :2]
        self._nees += _finite(nees(place, cov[:, :2, :2]))
        self._full += _finite(_full_nees(place, true.yaw, true.velocity, found.yaw, found.velocity, cov))
        for actor, track in paired.partner.items():
            if fed.get(track) == actor and track in nis:
                self._nis += _finite(np.array([nis[track] / NIS_DIMENSION]))

    def _pairs(self, frame: Frame, truth: Truth, paired: Paired) -> tuple[I64, I64]:
        """Matched pairs, then the rest by the filter's gate, as indices into `paired`."""
        error = (
            truth.boxes.center[paired.objects, None, :2] - frame.tracks.boxes.center[None, paired.tracks, :2]
        )
        S = frame.tracks.cov[paired.tracks][:, :2, :2] + self._noise**2 * np.eye(2)
        det = S[:, 0, 0] * S[:, 1, 1] - S[:, 0, 1] * S[:, 1, 0]
        x, y = error[..., 0], error[..., 1]
        form = S[:, 1, 1] * x**2 - (S[:, 0, 1] + S[:, 1, 0]) * x * y + S[:, 0, 0] * y**2
        inside = (form <= self._gate * det) & (det > 0) & paired.allowed
        inside[paired.pairs[:, 0], :] = False
        inside[:, paired.pairs[:, 1]] = False
        i, j = assign(paired.distance, inside)
        return np.concatenate([paired.pairs[:, 0], i]), np.concatenate([paired.pairs[:, 1], j])

    def scores(self) -> dict[str, float | None]:
        """The named scores."""
        return {"consistency.nees": mean(self._nees), "consistency.nis": mean(self._nis)}

    def samples(self) -> tuple[list[float], list[float]]:
        """Every NEES of a place, and every NIS, each by its dimension."""
        return self._nees, self._nis

    def detail(self, hidden: list[float]) -> dict[str, Any]:
        """What stands beside: spreads, the full state, and the owners of `hidden` objects apart."""
        return {
            "nees": spread(self._nees),
            "nees_full_state": spread(self._full),
            "nees_hidden": spread(hidden),
            "nis": spread(self._nis),
        }


def _full_nees(place: F64, true_yaw: F64, true_velocity: F64, yaw: F64, velocity: F64, cov: F64) -> F64:
    """NEES over (x, y, yaw, speed), the lesser of the two ways to tell the same motion."""
    speed = velocity[:, 0] * np.cos(yaw) + velocity[:, 1] * np.sin(yaw)
    true_speed = true_velocity[:, 0] * np.cos(true_yaw) + true_velocity[:, 1] * np.sin(true_yaw)
    ways: list[F64] = []
    for turn, sign in ((0.0, 1.0), (np.pi, -1.0)):
        turned = wrap_angle(yaw - true_yaw - turn)
        error = np.column_stack([place, turned, speed - sign * true_speed])
        ways.append(nees(np.nan_to_num(error), cov[:, :4, :4]))
    known = np.isfinite(speed) & np.isfinite(true_speed)
    return np.where(known, np.fmin(ways[0], ways[1]), np.nan)


def _finite(values: Array) -> list[float]:
    kept: list[float] = values[np.isfinite(values)].tolist()
    return kept
