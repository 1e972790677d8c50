"""Scenes of the ground benchmark: scans, their truth and the true relief, made by the simulator."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path

import numpy as np
from scipy import fft

import scenarios
import sim
from datmo.arrays import F64
from datmo.errors import ConfigError
from datmo.messages import Relief, Scan, Truth
from eval.benchmark.ground_scenario import check_grade, entropy, rms_of, scenario_of
from eval.benchmark.store import Arrays, kept, pack, unpack
from eval.metrics.ground import grid_centres
from scenarios.spec import Scenario
from sim.env import LidarEnv
from sim.scene.roughness import CLASSES, rough_field

GRADES = (0.0, 5.0, 10.0, 15.0)
APART = 10
"""Sweeps from one kept scan of a scene to the next."""
LIBRARIES = ("numpy", "scipy", "numba", "highway-env", "embreex", "trimesh")
PIXEL, SIDE, LONGEST = 0.25, 320.0, 50.0
"""Spacing, side and longest wave of the height map of a stated rms [m]."""


@dataclass(frozen=True, eq=False)
class Scene:
    """One scan of the grid, with its truth.

    Attributes:
        name: class and grade, such as "E-10", and "E-10#1" for the second scan.
        roughness: ISO 8608 class of the field, "flat", or an rms height [m] as text, such as "0.3".
        grade: of the steepest flank [%].
        scan, truth: of the simulator. relief: true ground at `grid_centres()`.
    """

    name: str
    roughness: str
    grade: float
    scan: Scan
    truth: Truth
    relief: Relief


def scenes(
    classes: Sequence[str] = tuple(CLASSES),
    grades: Sequence[float] = GRADES,
    seed: int = 0,
    scans: int = 1,
    on_scene: Callable[[int, str], None] | None = None,
) -> Iterator[Scene]:
    """The scenes of a grid, class by class; each is made when it is asked for, and kept on disk.

    A scene does not depend on which others are asked for.

    Args:
        classes: "A" to "H", "flat", or rms heights such as "0.3" [m]. grades: [%].
        seed: of all scenes. scans: of each, `APART` sweeps apart.
        on_scene: told how many grid points are done, and the name of the next one.

    Raises:
        ConfigError: an unknown class, an impossible grade, an empty list, or no scan.
    """
    check(classes, grades, seed, scans)
    return _made([(c, float(g)) for c in classes for g in grades], seed, scans, on_scene)


def check(classes: Sequence[str], grades: Sequence[float], seed: int, scans: int = 1) -> None:
    """Refuse what cannot be made, before anything is.

    Raises:
        ConfigError: as `scenes`.
    """
    for name, values in (("classes", classes), ("grades", grades)):
        if not values:
            raise ConfigError(f"{name} is empty; a grid has at least one; give e.g. {_example(name)}")
    for roughness in classes:
        rms_of(roughness)
    for grade in grades:
        check_grade(grade)
    if seed < 0 or scans < 1:
        raise ConfigError(f"seed {seed}, scans {scans}: give a seed of 0 or more and at least 1 scan")


def _example(name: str) -> str:
    return "A,E" if name == "classes" else "0,10"


def _made(
    grid: Sequence[tuple[str, float]], seed: int, scans: int, on_scene: Callable[[int, str], None] | None
) -> Iterator[Scene]:
    for done, (roughness, grade) in enumerate(grid):
        name = f"{roughness}-{grade:g}"
        if on_scene is not None:
            on_scene(done, name)
        key = _key(roughness, grade, seed, scans)
        arrays = kept(key, partial(_make, roughness, grade, seed, scans))
        for k in range(scans):
            parts = (unpack(kind, arrays, f"{k}.{kind.__name__}") for kind in (Scan, Truth, Relief))
            yield Scene(f"{name}#{k}" if k else name, roughness, grade, *parts)  # type: ignore[arg-type]


def _make(roughness: str, grade: float, seed: int, scans: int) -> Arrays:
    rms, own = rms_of(roughness), entropy(roughness, grade, seed)
    if rms is None:
        return _play(scenario_of(roughness, grade, seed), own, scans)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "ground.npy"
        np.save(path, _field(rms, own))
        return _play(scenario_of(roughness, grade, seed, str(path)), own, scans)


def _play(scenario: Scenario, seed: Sequence[int], scans: int) -> Arrays:
    """The scans of one episode, with truth and relief, as arrays."""
    env, centres = LidarEnv(scenario), grid_centres()
    arrays: Arrays = {}
    _, info = env.reset(seed=int(np.random.default_rng(seed).integers(2**31)))
    for k in range(scans):
        for _ in range(APART if k else 0):
            info = env.step(0)[4]
        for message in (info["scan"], info["truth"], env.relief(centres)):
            arrays |= pack(message, f"{k}.{type(message).__name__}")
    env.close()
    return arrays


def _field(rms: float, seed: Sequence[int]) -> F64:
    """A rough field (n, n) of this rms [m], with ISO 8608's spectrum up to waves of `LONGEST`.

    Longer waves would hold most of the height, and none of what is rough within the scored radius.
    """
    side = round(SIDE / PIXEL) + 1
    field = rough_field((side, side), PIXEL, "E", np.random.SeedSequence([*seed, 2]))
    n = np.hypot(fft.fftfreq(side, PIXEL)[:, None], fft.rfftfreq(side, PIXEL)[None, :])
    short = fft.irfft2(np.where(n >= 1 / LONGEST, fft.rfft2(field), 0), s=field.shape)
    return np.asarray(short * (rms / short.std()))


def _key(roughness: str, grade: float, seed: int, scans: int) -> str:
    """SHA-256 of all that a scene is made of."""
    digest = hashlib.sha256(_makers())
    file = None if rms_of(roughness) is None else "field"
    digest.update(scenario_of(roughness, grade, seed, file).model_dump_json().encode())
    digest.update(repr((entropy(roughness, grade, seed), scans, APART, PIXEL, SIDE, LONGEST)).encode())
    return digest.hexdigest()


@cache
def _makers() -> bytes:
    """Who makes scenes: the simulator's code and tables, this file, the libraries under it."""
    roots = [Path(p) for module in (sim, scenarios) for p in module.__path__]
    files = [p for root in roots for ending in ("*.py", "*.csv") for p in sorted(root.rglob(ending))]
    digest = hashlib.sha256(" ".join(f"{name} {version(name)}" for name in LIBRARIES).encode())
    for path in [*files, Path(__file__)]:
        digest.update(path.read_bytes())
    return digest.digest()
