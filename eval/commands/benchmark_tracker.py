"""datmo benchmark tracker: the tracker on real sequences, beside a Kalman filter and the thesis."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eval.commands import options as o

if TYPE_CHECKING:
    from eval.benchmark.kitti_tracks import Drive

Real = Annotated[
    Path | None,
    typer.Option("--real", metavar="DIR", help="Folder of real data; default $DATMO_REAL_DATA."),
]
Names = Annotated[
    list[str] | None, typer.Option("--sequence", metavar="NNNN", help="Play this one alone; repeatable.")
]
FitNoise = Annotated[
    bool, typer.Option("--fit-noise", help="Only tell what the labels say of the detections' noise.")
]
Speed = Annotated[bool, typer.Option("--speed", help="Only measure how long a step takes.")]
Ablation = Annotated[bool, typer.Option("--ablation", help="Also without each idea of the tracker, in turn.")]


def tracker(
    real: Real = None,
    sequence: Names = None,
    ablation: Ablation = False,
    fit_noise: FitNoise = False,
    speed: Speed = False,
    out: o.OutFolder = None,
    force: o.Force = False,
) -> None:
    """Ours, the thesis's and a Kalman tracker on KITTI's cars, scored by TrackEval on 3-D overlap.

    With --out, leaves tracker.json and tracker.md in DIR. See `datmo benchmark recovery` for what hides.

    \b
    Examples:
      datmo benchmark tracker
      datmo benchmark tracker --sequence 0003 --ablation --out runs/tracker
      datmo benchmark tracker --fit-noise
      datmo benchmark tracker --speed
    """
    from eval import console
    from eval.benchmark.table import rich_table
    from eval.benchmark.tracker_noise import noise_table
    from eval.benchmark.tracker_report import score, shown, write
    from eval.benchmark.tracker_speed import measure, speed_table
    from eval.output import refuse_existing

    if out is not None:
        refuse_existing(out, force)
    screen = console.stdout()
    if speed or fit_noise:
        rows = speed_table(measure()) if speed else noise_table(_sequences(real, sequence))
        screen.print(rich_table(rows))
        return
    scores, without = score(_sequences(real, sequence), ablation)
    for made in shown(scores, without):
        screen.print(rich_table(made))
    if out is not None:
        write(scores, without, out, force)
        screen.print(f"written: {out}", markup=False)


def _sequences(real: Path | None, names: list[str] | None) -> list[Drive]:
    from eval.benchmark.ground_real import default_folder
    from eval.benchmark.kitti_tracks import drives, read_drive

    folder = (real or default_folder()) / "real" / "tracks"
    return [read_drive(folder, name) for name in names or drives(folder)]
