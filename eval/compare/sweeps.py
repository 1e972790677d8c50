"""Where the sweeps come from: files of a real lidar, and an episode of a scenario."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from datmo.arrays import F64, U8
from datmo.errors import CloudFileError
from datmo.messages import Kind
from datmo.refine import rings_of
from eval import clouds
from eval.compare.elevation import errors
from eval.compare.judge import Line, judge
from eval.compare.profile import Profile, mean, profile
from eval.episode import episode
from scenarios.spec import Scenario
from sim.env import LidarEnv
from sim.export.semantickitti import MOVING_CLASS, STATIC
from sim.scan.units import MOST_RINGS, unit

KINDS = {code: kind for kind, code in STATIC.items() if kind != Kind.VAN}
KINDS |= {code: kind for kind, code in MOVING_CLASS.items() if kind != Kind.VAN}
KINDS |= {44: Kind.SIDEWALK, 49: Kind.FIELD, 60: Kind.ROAD, 52: Kind.BUILDING}
"""SemanticKITTI's classes; parking counts as sidewalk, other ground as field, lane marking as road."""


def real(path: Path) -> Profile:
    """Statistics of a cloud file, with classes where a .label of the same name lies beside it.

    SemanticKITTI keeps labels/000000.label beside velodyne/000000.bin; that is found too.

    Raises:
        CloudFileError: the file is none, or its points are not stored ring by ring.
    """
    cloud = clouds.read_bin(path)
    ring = rings_of(cloud.scan.points)
    if not 1 < ring.max() + 1 <= MOST_RINGS:
        raise CloudFileError(
            f"{path} has {ring.max() + 1} turns of azimuth; a sweep is stored ring by ring, as KITTI's are"
        )
    kind = _labels(path)
    return profile(
        cloud.scan.points,
        cloud.scan.intensity,
        ring.astype(np.uint8),
        None if kind is None else kind[cloud.kept],
    )


def _labels(path: Path) -> U8 | None:
    beside = [path.with_suffix(".label"), path.parent.parent / "labels" / f"{path.stem}.label"]
    found = next((p for p in beside if p.is_file()), None)
    if found is None:
        return None
    code = np.fromfile(found, "<u4") & 0xFFFF
    if len(code) * clouds.POINT_BYTES != path.stat().st_size:
        raise CloudFileError(f"{found} has {len(code)} labels, {path.name} other points; give the right pair")
    table = np.zeros(0x10000, np.uint8)
    for number, kind in KINDS.items():
        table[number] = kind
    return np.asarray(table[code], np.uint8)


def simulated(
    scenario: Scenario, seed: int, sweeps: int, tell: Callable[[int, str], None]
) -> tuple[list[Profile], F64]:
    """Statistics of `sweeps` sweeps spread over an episode, and each ring's error of elevation (L,) [deg].

    The ego's motion is left in the points: taken out, the angles are no longer those of the beams.

    Args:
        tell: called with the number of scans played.
    """
    raw = scenario.sensor.model_copy(update={"deskew": "none"})
    env = LidarEnv(scenario.model_copy(update={"sensor": raw}))
    wanted = set(np.unique(np.linspace(0, scenario.scans - 1, sweeps).round().astype(int)).tolist())
    found, off = [], []
    table = unit(scenario.sensor.unit)
    for k, info in enumerate(episode(env, scenario, seed, scenario.scans)):
        if k in wanted:
            scan, truth = info["scan"], info["truth"]
            found.append(profile(scan.points, scan.intensity, scan.ring, truth.kind))
            off.append(errors(scan.points, scan.ring, table))
        tell(k + 1, "")
    env.close()
    return found, _median(off)


def side_by_side(
    paths: Sequence[Path], scenario: Scenario, seed: int, sweeps: int, tell: Callable[[int, str], None]
) -> tuple[Profile, Profile, list[Line]]:
    """Mean statistics of the real and of the simulated sweeps, and the lines that compare them."""
    measured = mean([real(path) for path in paths])
    played, off = simulated(scenario, seed, sweeps, tell)
    made = mean(played)
    return measured, made, judge(measured, made, unit(scenario.sensor.unit), off)


def _median(rows: Sequence[F64]) -> F64:
    """Over sweeps, without what is NaN."""
    values = np.array(rows)
    return np.array([np.median(c[np.isfinite(c)]) if np.isfinite(c).any() else np.nan for c in values.T])
