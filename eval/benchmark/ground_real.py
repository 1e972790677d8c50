"""Real sweeps without ground truth: time, agreement, consistency under tilt and warp, leak into boxes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from datmo.arrays import F32
from datmo.errors import CloudFileError
from datmo.messages import Scan
from eval import clouds
from eval.benchmark.ground_boxes import read_boxes
from eval.benchmark.ground_figures import Figures
from eval.benchmark.ground_grid import in_turn, rival_of, time_figures
from eval.benchmark.ground_methods import Contestant
from eval.benchmark.table import Rows, say
from eval.metrics.ratio import mean, ratio

VARIABLE = "DATMO_REAL_DATA"
PITCHES = (5.0, 10.0, 15.0)  # [deg]
WARPS = ((0.6, 20.0), (1.0, 15.0))  # height and length of the waves [m]
COLUMNS = (
    ("ms", "time [ms]", 1, 1),
    ("ratio", "ratio", 1, 2),
    ("agreement", "agrees with Patchwork++ [%]", 100, 2),
    *((f"changed_pitch_{p:g}", f"changed, pitch {p:g} deg [%]", 100, 2) for p in PITCHES),
    *((f"changed_warp_{a:g}_{w:g}", f"changed, warp {a:g} m in {w:g} m [%]", 100, 2) for a, w in WARPS),
    ("box_leak", "leak into boxes [%]", 100, 2),
)
"""Figure, head, factor and digits."""


@dataclass(frozen=True)
class RealRow:
    """What one contestant did with one real sweep."""

    frame: str
    method: str
    figures: Figures


def default_folder() -> Path:
    """Where real sweeps are looked for: `DATMO_REAL_DATA`, or ../shared/data beside the project."""
    beside = Path(__file__).parents[2].parent / "shared" / "data"
    return Path(os.environ.get(VARIABLE, beside))


def sweeps(folder: Path) -> list[Path]:
    """The sweeps of real/frames and real/boxes, or the .bin files of the folder itself."""
    found = [*sorted((folder / "real" / "frames").glob("*.bin"))]
    found += sorted((folder / "real" / "boxes").glob("*/velodyne.bin"))
    return found or sorted(folder.glob("*.bin"))


def pitched(points: F32, degrees: float) -> F32:
    """The points turned nose down about the y axis."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.asarray(points @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T, np.float32)


def warped(points: F32, height: float, length: float) -> F32:
    """The points lifted by waves of this height and length along x [m]: z + a sin(2πx/w)."""
    wave = height * np.sin(2 * np.pi * points[:, 0] / length)
    return np.asarray(np.column_stack([points[:, :2], points[:, 2] + wave]), np.float32)


def changed_scans(scan: Scan) -> dict[str, Scan]:
    """The sweep tilted and warped, by the name of the figure."""
    made = {f"changed_pitch_{p:g}": pitched(scan.points, p) for p in PITCHES}
    made |= {f"changed_warp_{a:g}_{w:g}": warped(scan.points, a, w) for a, w in WARPS}
    return {name: replace(scan, points=points) for name, points in made.items()}


def play_real(contestants: Sequence[Contestant], paths: Sequence[Path], rounds: int) -> list[RealRow]:
    """A row for each sweep and contestant.

    Raises:
        CloudFileError: a file cannot be read.
    """
    rows = []
    for path in paths:
        labelled = path.name == "velodyne.bin"
        frame = f"boxes/{path.parent.name}" if labelled else f"frames/{path.stem}"
        found = _one(contestants, path, rounds, labelled)
        rows += [RealRow(frame, contestant, figures) for contestant, figures in found]
    return rows


def _one(
    contestants: Sequence[Contestant], path: Path, rounds: int, labelled: bool
) -> list[tuple[str, Figures]]:
    scan, rival = clouds.read_bin(path).scan, rival_of(contestants)
    inside = np.zeros(len(scan), bool)
    for box in read_boxes(path.parent) if labelled else []:
        inside |= box.above_foot(scan.points)
    grounds, times = in_turn(contestants, scan, rounds)
    others = {name: in_turn(contestants, other, 0)[0] for name, other in changed_scans(scan).items()}
    made = []
    for i, (contestant, ground) in enumerate(zip(contestants, grounds, strict=True)):
        own = ground.is_ground
        figures: Figures = dict(time_figures(times, i, rival))
        figures["agreement"] = None if rival is None else float(np.mean(own == grounds[rival].is_ground))
        figures |= {name: float(np.mean(own != other[i].is_ground)) for name, other in others.items()}
        figures["box_leak"] = ratio(int((inside & own).sum()), int(inside.sum()))
        made.append((contestant.name, figures))
    return made


def real_table(rows: Sequence[RealRow]) -> Rows:
    """Means over the sweeps, a row for each method."""
    made = []
    for method in dict.fromkeys(row.method for row in rows):
        part = [row.figures for row in rows if row.method == method]
        means = {n: mean([v for f in part if (v := f[n]) is not None]) for n, *_ in COLUMNS}
        made.append((method, *(say(means[n], factor, digits) for n, _, factor, digits in COLUMNS)))
    return Rows("real sweeps", ("real sweeps", *(head for _, head, _, _ in COLUMNS)), tuple(made), left=1)


def real_paths(folder: Path | None) -> tuple[list[Path], str | None]:
    """The sweeps to use and, where there are none at the default place, a note.

    Raises:
        CloudFileError: a folder was asked for, and holds no sweep.
    """
    where = default_folder() if folder is None else folder
    paths = sweeps(where)
    if not paths and folder is not None:
        raise CloudFileError(
            f"--real {folder}: no sweep there; give a folder with real/frames/*.bin, or with *.bin files"
        )
    return (
        paths,
        None if paths else f"real sweeps are left out: none at {where}; give --real or set {VARIABLE}",
    )
