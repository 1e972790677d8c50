"""What refine, clusters and boxes of a sweep cost, beside the usual Python loop of the rectangle search."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from datmo.arrays import F64, I64
from datmo.boxes import fit_boxes
from datmo.boxes.gather import gather
from datmo.clusters import cluster
from datmo.config import DatmoConfig
from datmo.errors import ConfigError
from datmo.geometry import transform
from datmo.ground import segment_ground
from datmo.messages import Scan
from datmo.pipeline import ground_below
from datmo.refine import refine
from eval.clouds import read_bin
from eval.episode import episode
from scenarios.load import load
from sim.env import LidarEnv

FIT = "boxes and filter"
STAGES = ("refine", "cluster", FIT)
RIVAL = "Python loop"
REPEATS = 10
"""Runs of a stage in a round: the rival takes a second and leaves cold caches."""
CROWDED = "crowded-street"
CHANGED: Mapping[str, Mapping[str, str]] = {
    CROWDED: {
        "scenery.rows.1.share": "0.2",
        "scenery.rows.2.share": "0.2",
        "scenery.rows.3.every": "8",
        "scenery.rows.4.every": "8",
        "scenery.rows.5.every": "8",
        "scenery.rows.6.every": "3",
        "scenery.rows.6.share": "1",
    }
}
"""Sweeps of no scenario: city-street with few walls and hedges, many trees, lamps, signs and bins."""
DEFAULT = ("rough-crossing", "city-street", CROWDED)


@dataclass(frozen=True)
class Sweep:
    """A scan and where it is from."""

    source: str
    scan: Scan


@dataclass(frozen=True)
class Result:
    """What one sweep costs.

    Attributes:
        source: where it is from. points: of the sweep. clustered: points that belong to a cluster.
        clusters, boxes: their numbers. times: of each run, by stage and rival [ms].
    """

    source: str
    points: int
    clustered: int
    clusters: int
    boxes: int
    times: Mapping[str, tuple[float, ...]]

    def best(self, name: str) -> float:
        """Of a stage or of the rival [ms]."""
        return min(self.times[name])

    @property
    def total(self) -> float:
        """The best of each stage, summed [ms]."""
        return sum(self.best(stage) for stage in STAGES)


def python_loop(xy: F64, starts: I64, step: float = 1.0, nearest: float = 0.05) -> F64:
    """The rectangle search as tutorials of robotics write it: a loop over clusters and over angles.

    Closeness criterion (Zhang 2017, algorithms 2 and 4) over all the points of a cluster, with numpy for
    each angle.

    Args:
        xy: (n, 2) [m], cluster by cluster. starts: (k + 1,). step: between angles [deg].
        nearest: least distance to an edge [m].

    Returns:
        Angle (k,) of the best rectangle [rad, 0 <= angle < pi/2].
    """
    found = []
    for k in range(len(starts) - 1):
        points = xy[starts[k] : starts[k + 1]]
        best, best_angle = -np.inf, 0.0
        for angle in np.deg2rad(np.arange(0, 90, step)):
            distances = []
            for u, v in ((np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))):
                along = u * points[:, 0] + v * points[:, 1]
                to_high, to_low = along.max() - along, along - along.min()
                distances.append(to_high if np.linalg.norm(to_high) < np.linalg.norm(to_low) else to_low)
            score = float(np.sum(1 / np.maximum(np.minimum(*distances), nearest)))
            if score > best:
                best, best_angle = score, float(angle)
        found.append(best_angle)
    return np.array(found)


def first_sweep(name: str, seed: int = 0) -> Sweep:
    """The first sweep of an episode of a scenario, a file, or one of `CHANGED`.

    Raises:
        ScenarioError: no such scenario.
    """
    world = load("city-street" if name in CHANGED else name, CHANGED.get(name))
    env = LidarEnv(world)
    try:
        return Sweep(f"{name}, seed {seed}", next(episode(env, world, seed, 1))["scan"])
    finally:
        env.close()


def sweeps_of(names: Sequence[str], clouds: Sequence[Path], seed: int) -> list[Sweep]:
    """The sweeps of cloud files, and the first of each scenario; of `DEFAULT` where neither is named.

    Raises:
        CloudFileError: a file that is none. ScenarioError: no such scenario.
    """
    names = names or (() if clouds else DEFAULT)
    files = [Sweep(path.name, read_bin(path).scan) for path in clouds]
    return files + [first_sweep(name, seed) for name in names]


def benchmark_boxes(sweep: Sweep, rounds: int, on_round: Callable[[], object] = bool) -> Result:
    """Time the stages on one sweep, and the rival on the same clusters, in turn.

    Each stage has its inputs ready: the ground is told once, before. The rival meets every point of every
    cluster.

    Args:
        rounds: how often. on_round: called after each.

    Raises:
        ConfigError: no round, or a sweep without clusters.
    """
    if rounds < 1:
        raise ConfigError(f"rounds is {rounds}; the best of at least 1 is told; give 1 or more")
    scan, config = sweep.scan, DatmoConfig()
    keep = refine(scan, config.refine)
    ground = segment_ground(scan.points, config=config.ground, keep=keep)
    height, elevated = scan.points[:, 2] - ground.height, keep & ~ground.is_ground
    clusters = cluster(scan.points, height, elevated, config.clusters)
    if clusters.count == 0:
        raise ConfigError(f"{sweep.source} has no cluster to fit a box to; give another sweep")
    places, below = transform(scan.T_world_sensor, scan.points), ground_below(scan, ground)
    sensor = scan.T_world_sensor[:2, 3]
    boxes, _ = fit_boxes(places, clusters, below, sensor, config.boxes)
    points, _, starts = gather(places, below, clusters.label, clusters.count)
    work: dict[str, Callable[[], object]] = {
        "refine": lambda: refine(scan, config.refine),
        "cluster": lambda: cluster(scan.points, height, elevated, config.clusters),
        FIT: lambda: fit_boxes(places, clusters, below, sensor, config.boxes),
        RIVAL: lambda: python_loop(points[:, :2], starts, config.boxes.step, config.boxes.nearest),
    }
    times = _take_turns(work, rounds, on_round)
    return Result(sweep.source, len(scan), len(points), clusters.count, len(boxes), times)


def _take_turns(
    work: Mapping[str, Callable[[], object]], rounds: int, on_round: Callable[[], object]
) -> dict[str, tuple[float, ...]]:
    """Times of each run, by name [ms]; the rival runs once a round, the stages `REPEATS` times.

    The rival takes so long that it shares the processor with whatever else runs: its own time counts.
    """
    times: dict[str, list[float]] = {name: [] for name in work}
    for _ in range(rounds):
        for name, run in work.items():
            clock, repeats = (process_time, 1) if name == RIVAL else (perf_counter, REPEATS)
            for _ in range(repeats):
                start = clock()
                run()
                times[name].append((clock() - start) * 1e3)
        on_round()
    return {name: tuple(found) for name, found in times.items()}
