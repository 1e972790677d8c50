"""How much a sweep with truth costs over a bare Embree cast of the same rays at the same terrain."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from datmo.arrays import F32, F64
from datmo.errors import ConfigError
from datmo.messages import Kind
from scenarios import spec
from sim.scan.embree import Mesh
from sim.scan.motion import sweep_motion, world_rays
from sim.scan.sweep import STAGES, Lidar
from sim.scene.assets import asset
from sim.scene.contact import stand
from sim.scene.motion import Poses, edges
from sim.scene.terrain import Terrain, build_terrain

RATE, EXTENT, COARSEST = 10.0, 200.0, 100
BLOCKS, THREADS = 8, 2
NEAREST, FARTHEST = 5.0, 75.0
FLEET = ("car/0", "car/1", "van/0", "car/2", "truck/0", "pedestrian/0/3", "car/3", "pedestrian/1/5")


@dataclass(frozen=True)
class Point:
    """One number of actors, medians over the rounds.

    Attributes:
        actors: in range. bare_ms, sweep_ms: [ms]. ratio: median of the rounds' ratios.
        low, high: quartiles of the ratio. best: of the fastest sweep to the fastest bare cast, which holds
        also where others take the processors away.
        caught: rays that would hit an actor.
        stages: of the sweep [ms].
    """

    actors: int
    bare_ms: float
    sweep_ms: float
    ratio: float
    low: float
    high: float
    best: float
    caught: int
    stages: dict[str, float]


def benchmark_cast(
    actors: Sequence[int] = (0, 10, 40, 160),
    cells: int = 800,
    rounds: int = 15,
    on_round: Callable[[int], None] | None = None,
) -> list[Point]:
    """Time full sweeps (cast, returns, truth) and bare casts in turn.

    The bare cast is `run(origins, directions)` of embreex: ready float32 rays, 8 blocks, two threads.

    Args:
        actors: numbers of moving actors, 5 to 75 m from the ego, evenly over the area.
        cells: of the terrain along each side; it has 2 cells² triangles over 200 x 200 m.
        rounds: sweeps of each number. on_round: told how many rounds are done.

    Raises:
        ConfigError: a number is impossible.
    """
    if min(actors, default=-1) < 0 or cells < COARSEST or rounds < 1:
        raise ConfigError(
            f"actors {list(actors)}, {cells} cells, {rounds} rounds: give 0 actors or more, at least "
            f"{COARSEST} cells and at least 1 round"
        )
    half = EXTENT / 2
    model = spec.Terrain(roughness="D", cell=EXTENT / cells)
    terrain = build_terrain(model, (), (-half, -half, half, half), np.random.SeedSequence(1))
    lidar = Lidar(spec.Sensor(), RATE, terrain, (), np.random.SeedSequence(2))
    scenes = [scene(lidar, terrain, count) for count in actors]
    bare = bare_cast(lidar, terrain, scenes[0])
    times = np.zeros((len(actors), rounds, 2))
    stages = np.zeros((len(actors), rounds, len(STAGES)))
    caught = [int(lidar.sweep(poses, 0)[1].solo.sum()) for poses in scenes]
    bare()
    for k in range(rounds):
        for i, poses in enumerate(scenes):
            times[i, k] = timed(bare), timed(lambda p=poses, k=k: lidar.sweep(p, k))  # type: ignore[misc]
            stages[i, k] = list(lidar.milliseconds.values())
        if on_round is not None:
            on_round(k + 1)
    return [_point(*row) for row in zip(actors, times, caught, stages, strict=True)]


def timed(work: Callable[[], object]) -> float:
    """How long `work` takes [ms]."""
    start = perf_counter()
    work()
    return (perf_counter() - start) * 1e3


def scene(lidar: Lidar, terrain: Terrain, actors: int) -> Poses:
    """One sweep: an ego at 8 m/s that turns, and actors around it, each with a speed of its own."""
    rng = np.random.default_rng(3)
    time = edges(lidar.pattern.columns, lidar.pattern.period)
    radius = NEAREST + (FARTHEST - NEAREST) * np.sqrt((np.arange(actors) + 0.5) / max(actors, 1))
    bearing = rng.uniform(-np.pi, np.pi, actors)
    yaw, speed = rng.uniform(-np.pi, np.pi, actors), rng.uniform(0, 15, actors)
    looks = [asset(FLEET[i % len(FLEET)]) for i in range(actors)]
    size = np.array([a.size for a in looks]).reshape(-1, 3)[:, None]
    velocity = speed[:, None] * np.column_stack([np.cos(yaw), np.sin(yaw)])
    xy = radius[:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])
    places = xy[:, None] + time[None, :, None] * velocity[:, None]
    turned = np.broadcast_to(yaw[:, None], places.shape[:2])
    upright = np.array([a.kind == Kind.PEDESTRIAN for a in looks], bool)[:, None]
    heading = 0.3 * time
    ego = np.column_stack([8 * time, np.zeros_like(time)])
    return Poses(
        time=time,
        T_world_ego=stand(terrain, ego, heading, 4.2, 1.8),
        T_world_actor=stand(terrain, places, turned, size[..., 0], size[..., 1], upright),
        id=np.arange(1, actors + 1),
        kind=np.array([a.kind for a in looks], np.uint8),
        asset=tuple(a.key for a in looks),
        velocity=velocity,
    )


def bare_cast(lidar: Lidar, terrain: Terrain, poses: Poses) -> Callable[[], object]:
    """The rival: every ray of a sweep at the terrain alone, nothing made of what it meets."""
    mesh = Mesh(terrain.vertices, terrain.triangles)
    o, d = world_rays(lidar.pattern, sweep_motion(lidar.pattern, poses, lidar.T_ego_sensor))
    parts: list[tuple[F32, F32]] = list(
        zip(np.array_split(o, BLOCKS), np.array_split(d, BLOCKS), strict=True)
    )
    threads = ThreadPoolExecutor(THREADS)
    return lambda: list(threads.map(lambda part: mesh.run(*part), parts))


def _point(actors: int, times: F64, caught: int, stages: F64) -> Point:
    ratio = times[:, 1] / times[:, 0]
    low, middle, high = np.percentile(ratio, [25, 50, 75])
    bare, sweep = np.median(times, axis=0)
    parts = {name: float(ms) for name, ms in zip(STAGES, np.median(stages, axis=0), strict=True)}
    best = float(times[:, 1].min() / times[:, 0].min())
    quartiles = float(middle), float(low), float(high)
    return Point(actors, float(bare), float(sweep), *quartiles, best, caught, parts)
