"""The whole-frame objective (3.40): the log likelihood of all segments, with shared hyper-parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from datmo.ground.fields import DELTA_BOUND, Bound, Field, Packed
from datmo.ground.lbfgs import minimise
from datmo.ground.likelihood import evidence
from datmo.threads import over_rows

SIGNAL_BOUND: Bound = (0.005, 3.0)
NOISE_BOUND: Bound = (0.001, 1.0)
CURVATURE = 0.5


class FrameObjective:
    """𝓛(θ) = Σ_m [log p(z_m) - cost_m] and its gradient.

    θ = log σ_f, the shared parameters of log L and of log n, then their own. A = K + diag(floor² + n²):
    the noise is never below the sensor's. Sums run over segments in order, whatever the threads.
    """

    def __init__(self, cells: Packed, length: Field, noise: Field, floor: float) -> None:
        self.cells, self.length, self.noise, self.floor = cells, length, noise, floor
        self.names = ("sigma_f", *length.names, *noise.names)
        self.bounds = (SIGNAL_BOUND, *length.bounds, *noise.bounds)
        self._cuts = np.cumsum([1, len(length.names), len(noise.names), length.free])

    def theta(self, hyper: dict[str, float], own: Sequence[F64] = ()) -> F64:
        """θ from the shared parameters by name, σ_n² = floor² + n² among them, and the fields' own."""
        excess = np.sqrt(max(hyper["sigma_n"] ** 2 - self.floor**2, NOISE_BOUND[0] ** 2))
        shared = np.log([excess if name == "sigma_n" else hyper[name] for name in self.names])
        return np.concatenate([shared, *own])

    def hyper(self, theta: F64) -> dict[str, float]:
        """The shared parameters of θ by name."""
        values = np.exp(theta[: len(self.names)]).tolist()
        found = dict(zip(self.names, values, strict=True))
        return found | {"sigma_n": float(np.hypot(found["sigma_n"], self.floor))}

    def settle(self, theta: F64) -> None:
        """Leave both fields at θ."""
        _, by_length, by_noise, own_length, own_noise = np.split(theta, self._cuts)
        self.length.values(by_length, own_length)
        self.noise.values(by_noise, own_noise)

    def __call__(self, theta: F64) -> tuple[float, F64]:
        """Value and gradient at θ."""
        cells = self.cells
        log_sf, by_length, by_noise, own_length, own_noise = np.split(theta, self._cuts)
        log_L, cost_L = self.length.values(by_length, own_length)
        log_n, cost_n = self.noise.values(by_noise, own_noise)
        value, trace = np.zeros(len(cells.r)), np.zeros(len(cells.r))
        g, w = np.zeros(cells.r.shape), np.zeros(cells.r.shape)
        rows = (cells.r, cells.y, cells.count, log_L, log_n, value, trace, g, w)
        over_rows(evidence, rows, (float(log_sf[0]), self.floor))
        shared_L, free_L = self.length.gradient(g)
        shared_n, free_n = self.noise.gradient(w)
        gradient = np.concatenate([[trace.sum()], shared_L, shared_n, free_L, free_n])
        return float((value - cost_L - cost_n).sum()), gradient


@dataclass(frozen=True)
class Climbed:
    """Where a climb ended: θ, 𝓛(θ), how often 𝓛 was taken, and which latent parameters
    ended at a bound."""

    theta: F64
    value: float
    evaluations: int
    notes: tuple[str, ...]


def climb(objective: FrameObjective, theta: F64, steps: int) -> Climbed:
    """At most `steps` of L-BFGS from θ within the bounds.

    The shared parameters, on which every cell pulls, are scaled by the root of the number of cells.
    The curvature of log σ_n is then 2, and that of a whitened latent value about 1.
    """
    shared = len(objective.names)
    scale = np.ones(len(theta))
    scale[:shared] = np.sqrt(max(int(objective.cells.count.sum()), 1))
    limits = np.full((len(theta), 2), [-DELTA_BOUND, DELTA_BOUND])
    limits[:shared] = np.log(objective.bounds)

    def descent(t: F64) -> tuple[float, F64]:
        value, gradient = objective(t / scale)
        return -value, -gradient / scale

    low, high = (limits * scale[:, None]).T
    t, value, evaluations = minimise(descent, theta * scale, low, high, steps, CURVATURE)
    theta = t / scale
    notes = [
        f"{name} = {np.exp(theta[k]):.3g} is at its {side} bound"
        for k, name in enumerate(objective.names)
        for side, at in (("lower", limits[k, 0]), ("upper", limits[k, 1]))
        if name.startswith("bar_") and abs(theta[k] - at) < 1e-6
    ]
    return Climbed(theta, -value, evaluations, tuple(notes))
