"""Six line extractors on profiles whose lines are known: speed, correctness, precision (Appendix D)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from scipy.optimize import linear_sum_assignment

from datmo.arrays import F64
from datmo.bins import SEGMENTS
from datmo.errors import ConfigError
from datmo.ground.lines import COUNT, END, EXTRACTORS, INTERCEPT, SLOPE, START, LineRules, as_array, draw
from eval.benchmark.profiles import KINDS, Profile, make_profile

RULES = LineRules(join=0.06, rmse=0.03)
"""Three standard deviations of the largest noise; the same for all six."""
SHORTEST = 5
"""Lines of fewer points are nobody's: neither right nor wrong."""
YARDSTICK = "incremental"
OVERLAP, MOST_TURN, MOST_OFF = 0.5, np.radians(3.0), 0.1


@dataclass(frozen=True)
class Tally:
    """One extractor on one kind of profile, or on all.

    Attributes:
        true, found, matched: numbers of lines.
        true_positives, misses: shares of the true lines. false_positives: share of the found lines.
        sigma_r: of the distance from the sensor to the line [m]. sigma_alpha: of the angle of its
            normal [rad]. NaN with fewer than two matches.
    """

    true: int
    found: int
    matched: int
    true_positives: float
    false_positives: float
    misses: float
    sigma_r: float
    sigma_alpha: float


@dataclass(frozen=True)
class Result:
    """One extractor: tallies by kind, with "all"; median time of a segment [us]; time of a frame of 180,
    the sum of each segment's median over the rounds [ms]; its ratio to the incremental extractor's."""

    name: str
    tallies: dict[str, Tally]
    segment_us: float
    frame_ms: float
    ratio: float


def match(true: F64, found: F64) -> tuple[F64, F64]:
    """Errors of r [m] and alpha [rad] of the found lines (k, 7) that are true ones (t, 4), one to one.

    A pair shares half of what the two span together, differs by 3 degrees at most, and lies 0.1 m
    apart at most in the middle of what it shares. Of all pairings the one of most overlap counts.

    r and alpha are the line's polar form, r = x cos(alpha) + z sin(alpha) with the sensor as origin.
    """
    start = np.maximum(true[:, None, 0], found[None, :, START])
    end = np.minimum(true[:, None, 1], found[None, :, END])
    union = np.maximum(true[:, None, 1], found[None, :, END]) - np.minimum(
        true[:, None, 0], found[None, :, START]
    )
    overlap = np.maximum(end - start, 0) / np.maximum(union, 1e-9)
    turn = np.arctan(found[None, :, SLOPE]) - np.arctan(true[:, None, 2])
    middle = 0.5 * (start + end)
    off = (found[None, :, SLOPE] - true[:, None, 2]) * middle + found[None, :, INTERCEPT] - true[:, None, 3]
    fits = (overlap >= OVERLAP) & (np.abs(turn) <= MOST_TURN) & (np.abs(off) <= MOST_OFF)
    i, j = linear_sum_assignment(-np.where(fits, overlap, 0))
    i, j = i[fits[i, j]], j[fits[i, j]]
    r_true = true[i, 3] / np.hypot(1, true[i, 2])
    r_found = found[j, INTERCEPT] / np.hypot(1, found[j, SLOPE])
    return r_found - r_true, turn[i, j]


def tally(pairs: Sequence[tuple[F64, F64]]) -> Tally:
    """Over (true, found) lines of many profiles."""
    errors = [match(true, found) for true, found in pairs]
    r, alpha = (np.concatenate([e[c] for e in errors]) for c in (0, 1))
    true, found, matched = sum(len(t) for t, _ in pairs), sum(len(f) for _, f in pairs), len(r)
    share = matched / true
    return Tally(
        true,
        found,
        matched,
        share,
        (found - matched) / found if found else float("nan"),
        1 - share,
        float(r.std(ddof=1)) if matched > 1 else float("nan"),
        float(alpha.std(ddof=1)) if matched > 1 else float("nan"),
    )


def profiles(seeds: int, each: int, first: int = 0) -> list[Profile]:
    """`each` profiles of every kind for every seed from `first` on."""
    made = []
    for seed in range(first, first + seeds):
        for kind, stream in zip(KINDS, np.random.SeedSequence(seed).spawn(len(KINDS)), strict=True):
            rng = np.random.default_rng(stream)
            made += [make_profile(kind, rng) for _ in range(each)]
    return made


def benchmark_lines(
    seeds: int = 5,
    each: int = 36,
    rounds: int = 5,
    first: int = 0,
    on_round: Callable[[int], None] | None = None,
) -> list[Result]:
    """All extractors on the same profiles under the same rules, timed in turn.

    Args:
        seeds: of the profiles, from `first` on. each: profiles of a kind and seed.
        rounds: timed passes over one frame of 180 profiles. on_round: told how many are done.

    Raises:
        ConfigError: a number is less than 1, or `first` negative.
    """
    if min(seeds, each, rounds) < 1 or first < 0:
        raise ConfigError(
            f"{seeds} seeds from {first}, {each} profiles, {rounds} rounds: give 1 or more, and seeds from 0"
        )
    scenes = profiles(seeds, each, first)
    found = {name: [_lines(name, p) for p in scenes] for name in EXTRACTORS}
    times = np.empty((rounds, len(EXTRACTORS), SEGMENTS))
    frame = [scenes[m * len(scenes) // SEGMENTS] for m in range(SEGMENTS)]
    for k in range(rounds):
        times[k] = _race(frame)
        if on_round is not None:
            on_round(k + 1)
    return [_result(j, name, scenes, found[name], times) for j, name in enumerate(EXTRACTORS)]


def _race(frame: Sequence[Profile]) -> F64:
    """Seconds (extractors, profiles), each profile by all in turn, each time another first."""
    names = list(EXTRACTORS)
    times = np.empty((len(names), len(frame)))
    for m, profile in enumerate(frame):
        for j in np.roll(np.arange(len(names)), m):
            times[j, m] = _timed(names[j], profile)
    return times


def _result(j: int, name: str, scenes: Sequence[Profile], found: Sequence[F64], times: F64) -> Result:
    """Of extractor number j; times (rounds, extractors, segments) [s]."""
    both = list(zip(scenes, found, strict=True))
    tallies = {kind: tally([(p.lines, f) for p, f in both if p.kind == kind]) for kind in KINDS}
    tallies["all"] = tally([(p.lines, f) for p, f in both])
    each = np.median(times, axis=0)  # a pause of the machine spoils one round of one profile
    frame = each.sum(1)
    ratio = frame[j] / frame[list(EXTRACTORS).index(YARDSTICK)]
    return Result(name, tallies, float(np.median(each[j])) * 1e6, float(frame[j]) * 1e3, float(ratio))


def _lines(name: str, profile: Profile) -> F64:
    """What an extractor finds (k, 7), but for the shortest."""
    table = np.empty((len(profile.r), 7))
    k = EXTRACTORS[name](profile.r, profile.z, as_array(RULES), draw(name), table)
    return table[:k][table[:k, COUNT] >= SHORTEST]


def _timed(name: str, profile: Profile) -> float:
    """Seconds of one extraction, without the drawing of random numbers that a frame does once."""
    table, rules, draws, find = np.empty((len(profile.r), 7)), as_array(RULES), draw(name), EXTRACTORS[name]
    start = perf_counter()
    find(profile.r, profile.z, rules, draws, table)
    return perf_counter() - start
