"""What a track learns from not being seen: it is not where the rays found nothing.

A car that stops behind a wall would by its motion alone drive out of it, into a place that is seen to be
empty. Given that it was not found there it is likelier still behind the wall, and slower: the density of
its place is weighed by the probability not to be seen (negative information: Koch 2007, Fusion of
sensors; Stone, Corwin and Barlow 1999).
"""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, I64, Bool
from datmo.messages import Sight
from datmo.tracks.bank import Bank
from datmo.tracks.filters.moments import tame
from datmo.tracks.measurement.visibility import looks
from datmo.tracks.models import PSI, V

GRID = np.linspace(-2.5, 2.5, 11)  # along the heading, in deviations of the place
FOUND = 0.9  # probability to be found where all of it is seen
LEAST_NEWS = 0.1  # below this share of the density in empty places there is no news
NARROWEST, WIDEST = 0.05, 0.95  # variance of the place afterwards, over that before
FORWARD = 0.5  # [m/s] who went forwards does not go backwards for being unseen


def hold_back(bank: Bank, unseen: Bool, mean: F64, P: F64, lag: F64, sight: Sight) -> None:
    """Weigh the place along the heading of tracks that no box hit by what the rays show there, in place.

    The weighed density is matched in mean and variance by one linear measurement, which also moves what
    hangs together with the place: the speed.

    Args:
        bank: tracks (t), updated. unseen: (t,). mean: (t, n), P: (t, n, n) of all modes together.
        lag: (t, 2) [m] where the tracks were, from where they are at the stamp, when the rays came by.
        sight: how far the rays of this scan saw.
    """
    rows = np.flatnonzero(unseen)
    if len(rows) == 0:
        return
    heading = np.column_stack([np.cos(mean[rows, PSI]), np.sin(mean[rows, PSI])])
    var = np.einsum("ti,tij,tj->t", heading, P[rows][:, :2, :2], heading)
    offset, density = np.sqrt(var)[:, None] * GRID, np.exp(-(GRID**2) / 2)
    places = np.zeros((len(rows), len(GRID), 3))
    places[..., :2] = (mean[rows, :2] + lag[rows])[:, None] + offset[..., None] * heading[:, None]
    places[..., 2] = bank.z[rows, None]
    _, empty, known = looks(sight, places, bank.size[rows], bank.yaw[rows])
    weight = density * (1 - FOUND * empty / np.maximum(known, 1))
    total = weight.sum(axis=1)
    weight /= total[:, None]
    shift = np.einsum("tk,tk->t", weight, offset)
    after = np.einsum("tk,tk->t", weight, (offset - shift[:, None]) ** 2)
    whole = np.sum(density * GRID**2) / density.sum()  # of the cut density itself
    share = np.clip(after / (whole * var), NARROWEST, WIDEST)
    news = (1 - total / density.sum() > LEAST_NEWS) & (known.min(axis=1) > 0)
    _measure(bank, rows[news], heading[news], mean[rows[news], :2], shift[news], share[news], var[news])


def _measure(bank: Bank, rows: I64, heading: F64, at: F64, shift: F64, share: F64, var: F64) -> None:
    """Measure the place along `heading` such that it moves by `shift` and keeps `share` of `var`."""
    noise, distance = var * share / (1 - share), shift / (1 - share)
    x, P = bank.x[rows], bank.P[rows]
    of_place = np.einsum("tmij,tj->tmi", P[..., :2], heading)  # P h
    S = np.einsum("tmi,ti->tm", of_place[..., :2], heading) + noise[:, None]
    own = np.einsum("tmi,ti->tm", x[..., :2] - at[:, None], heading)
    moved = x + of_place * ((distance[:, None] - own) / S)[..., None]
    forward = x[..., V] > FORWARD
    moved[..., V] = np.where(forward, np.maximum(moved[..., V], 0.0), moved[..., V])
    moved[..., PSI] = x[..., PSI]
    bank.x[rows] = moved
    bank.P[rows] = tame(P - np.einsum("tmi,tmj->tmij", of_place, of_place) / S[..., None, None])
