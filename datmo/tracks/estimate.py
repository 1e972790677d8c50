"""The IMM over the bank of tracks: interaction, prediction, combined update."""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, Bool
from datmo.geometry import wrap_angle
from datmo.tracks.association.pda import Links
from datmo.tracks.bank import Bank
from datmo.tracks.config import TrackerConfig
from datmo.tracks.filters.base import Filters
from datmo.tracks.filters.imm import combine, lend, mix, rates, reweigh, transition
from datmo.tracks.filters.moments import gathered, tame
from datmo.tracks.measurement.pairs import Pairs
from datmo.tracks.models import ACCEL, OMEGA, make_models, state_size

LONGEST_STEP = 0.5  # [s] longer gaps are predicted in parts
MOVING_SPEED, STANDING_SHARE = 1.0, 0.02
TURNING_SPEED = 1.0  # [m/s] below which a box does not turn with the yaw rate


class Estimator:
    """Moves the states of a bank in time and takes measurements into them.

    Args:
        config: tuning.
        filters: what predicts and corrects each mode.
    """

    def __init__(self, config: TrackerConfig, filters: Filters) -> None:
        self.config, self.filters = config, filters
        self.models = make_models(config)
        self.size = state_size(self.models)
        self._has_yaw_rate = np.array([m.has_yaw_rate for m in self.models])
        self._has_acceleration = np.array([m.has_acceleration for m in self.models])
        self._stands = np.array([m.stands for m in self.models])
        self._rates = rates(config)

    def predict(self, bank: Bank, dt: float) -> tuple[F64, F64]:
        """Interaction (2.44-2.47) and prediction over `dt` [s], in place.

        Tracks that were not seen in the last scan neither mix nor change their modes.

        Returns:
            combined mean (t, n) and covariance (t, n, n).
        """
        if len(bank) and dt > 0:
            self._mix(bank, dt)
            parts = int(np.ceil(dt / LONGEST_STEP - 1e-9))
            for _ in range(parts):
                for j, model in enumerate(self.models):
                    state = self.filters.predict(model, bank.x[:, j], bank.P[:, j], dt / parts)
                    bank.x[:, j], bank.P[:, j] = state
        mean, P = self.combined(bank)
        turning = np.where(np.abs(mean[:, 3]) > TURNING_SPEED, mean[:, 4], 0)
        bank.yaw = wrap_angle(bank.yaw + turning * dt)
        bank.z = bank.z + bank.climb * dt
        return mean, P

    def combined(self, bank: Bank) -> tuple[F64, F64]:
        """One mean (t, n) and covariance (t, n, n) of all modes (2.53-2.54)."""
        return combine(*self._lent(bank), bank.mu)

    def update(self, bank: Bank, pairs: Pairs, links: Links, ratio: F64, before: F64) -> None:
        """Combined update with the spread of the innovations (2.63-2.67), and the modes (2.52).

        Each pair is corrected with its own noise, and the outcomes are matched in mean and
        covariance; with one noise for all that is the combined innovation with its spread term.

        Args:
            bank: predicted; changed in place.
            pairs: gated pairs. links: their probabilities.
            ratio: (p, m) N(nu_ij) / sum_j mu_bar_j N(nu_ij), the mode likelihood of section 12.
            before: (t, m) mode probabilities before the interaction.
        """
        m, n, prior_x, prior_P = len(self.models), self.size, bank.x, bank.P
        x, P = prior_x[pairs.track].reshape(-1, n), prior_P[pairs.track].reshape(-1, n, n)
        z, R, yaw, var = (np.repeat(a, m, axis=0) for a in (pairs.z, pairs.R, pairs.yaw, pairs.yaw_var))
        x, P = self.filters.correct(x, P, z, R, yaw, var)
        bank.x, second = gathered(
            prior_x,
            prior_P,
            x.reshape(-1, m, n),
            P.reshape(-1, m, n, n),
            pairs.track,
            links.beta,
            links.missed,
        )
        bank.P = tame(second)
        likelihood = np.repeat(links.missed[:, None], m, axis=1)
        np.add.at(likelihood, pairs.track, links.beta[:, None] * ratio)
        bank.mu = reweigh(bank.mu, likelihood)
        if self.config.freeze_unseen:
            unseen = np.ones(len(bank), np.bool_)
            unseen[pairs.track] = False
            bank.mu[unseen] = before[unseen]
            self._set_aside(bank, unseen)

    def _set_aside(self, bank: Bank, unseen: Bool) -> None:
        """Weigh models that stand almost out of what moves unseen: they would hold it back."""
        if self._stands.all():
            return
        mean, _ = self.combined(bank)
        rows = np.flatnonzero(unseen & (np.abs(mean[:, 3]) > MOVING_SPEED))
        mu = bank.mu[rows] * np.where(self._stands, STANDING_SHARE, 1.0)
        bank.mu[rows] = mu / mu.sum(axis=1, keepdims=True)

    def _mix(self, bank: Bank, dt: float) -> None:
        x, P, mu_bar = mix(*self._lent(bank), bank.mu, transition(self._rates, dt))
        free = bank.fresh if self.config.freeze_unseen else np.ones(len(bank), np.bool_)
        bank.x = np.where(free[:, None, None], x, bank.x)
        bank.P = np.where(free[:, None, None, None], P, bank.P)
        bank.mu = np.where(free[:, None], mu_bar, bank.mu)

    def _lent(self, bank: Bank) -> tuple[F64, F64]:
        x, P = bank.x, bank.P
        if not self.config.mix_yaw_rate:
            x, P = lend(x, P, bank.mu, OMEGA, self._has_yaw_rate)
        return lend(x, P, bank.mu, ACCEL, self._has_acceleration)
