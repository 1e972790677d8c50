"""Recovery of what was hidden, by how long and how it moved: trackers side by side on simulated scenes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from datmo.errors import ConfigError
from datmo.tracks import TrackerConfig
from eval.benchmark.recovery_play import Job, Played, play
from eval.benchmark.recovery_scenes import MOTIONS, Motion
from eval.benchmark.tracker_ablation import SIMULATED
from eval.benchmark.tracker_rivals import THESIS
from eval.metrics.recovery import Event
from eval.metrics.recovery_scores import duration_class
from eval.pool import run_all

OURS = "ours"
BINS = ("0.5-1", "1-2", "2-3", "3-5")
SECONDS = ((0.5, 1.0), (1.0, 2.0), (2.0, 3.0), (3.0, 5.0))
CELLS = tuple(product(MOTIONS, SECONDS, (False, True)))
"""Motion, seconds hidden and whether there are confusers, of the scenes of a seed."""
GROUPS: Mapping[str, Callable[[Event], bool]] = {
    "straight": lambda e: e.motion == "straight" and not e.confusers,
    "turning": lambda e: e.motion == "turning" and not e.confusers,
    "stop-and-go": lambda e: e.motion == "stop-and-go" and not e.confusers,
    "with confusers": lambda e: e.confusers > 0,
    "all": lambda _: True,
}
"""Which events count in each row."""
RIVALS: Mapping[str, TrackerConfig | None] = {"thesis": THESIS, "Kalman": None}
ABLATIONS: Mapping[str, TrackerConfig] = {name: TrackerConfig(**fields) for name, fields in SIMULATED.items()}
"""Each idea of the tracker switched off, on the boxes that the loop made with all of them."""


@dataclass(frozen=True)
class Recovery:
    """What one tracker made of all scenes; `events` beside the seed of each."""

    name: str
    events: tuple[tuple[Event, int], ...]
    censored: int
    ghosts: tuple[float, ...]
    nees: tuple[float, ...]
    nis: tuple[float, ...]

    def owned(self, group: str, seconds: str | None = None) -> list[tuple[Event, int]]:
        """Events with an owner, of a group of `GROUPS` and a class of `BINS`."""
        return [
            (e, s)
            for e, s in self.events
            if e.owner is not None and GROUPS[group](e) and seconds in (None, duration_class(e))
        ]


def benchmark_recovery(
    seeds: Sequence[int],
    beside: Mapping[str, TrackerConfig | None] = RIVALS,
    workers: int = 1,
    tell: Callable[[int], None] | None = None,
    enough: int | None = None,
) -> list[Recovery]:
    """Play a scene of every motion, duration and surrounding with every seed.

    Ours runs in the loop; the others are given the boxes of the same scans.

    Args:
        seeds: of the scenes, 24 each. beside: other trackers by name; None is the plain Kalman filter.
        workers: processes; the result does not depend on them. tell: told how many scenes are done.
        enough: a kind of scene whose class has so many events is played no more with later seeds.

    Raises:
        ConfigError: no seed.
    """
    if not seeds:
        raise ConfigError("no seeds to play; give at least one")
    jobs, played = list[Job](), list[dict[str, Played]]()
    for i, some in enumerate([seeds] if enough is None else [[seed] for seed in seeds]):
        short = [cell for cell in CELLS if enough is None or _events(cell, played) < enough]
        now = [Job(*cell, seed, beside=dict(beside)) for seed in some for cell in short]
        played += run_all(play, now, workers, _onward(tell, len(CELLS) * i))
        jobs += now
    if tell is not None:
        tell(len(CELLS) * len(seeds))
    return [_joined(name, jobs, [one[name] for one in played]) for name in (OURS, *beside)]


def _onward(tell: Callable[[int], None] | None, before: int) -> Callable[[int], None] | None:
    return None if tell is None else lambda done: tell(before + done)


def _events(cell: tuple[Motion, tuple[float, float], bool], played: Sequence[Mapping[str, Played]]) -> int:
    """Events so far, with an owner, of the class that a cell is made for."""
    motion, seconds, confusers = cell
    counts, asked = GROUPS["with confusers" if confusers else motion], BINS[SECONDS.index(seconds)]
    events = [e for one in played for e in one[OURS].events if e.owner is not None]
    return sum(counts(e) and duration_class(e) == asked for e in events)


def _joined(name: str, jobs: Sequence[Job], parts: Sequence[Played]) -> Recovery:
    return Recovery(
        name,
        tuple((event, job.seed) for job, part in zip(jobs, parts, strict=True) for event in part.events),
        sum(part.censored for part in parts),
        tuple(g for part in parts for g in part.ghosts),
        tuple(v for part in parts for v in part.nees),
        tuple(v for part in parts for v in part.nis),
    )
