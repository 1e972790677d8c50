"""datmo benchmark tracker: the tracker on real sequences, beside a Kalman filter and the thesis."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eval.commands import options as o

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
Ablation = Annotated[bool, typer.Option("--ablation", help="Also without each idea of the tracker, in turn.")]


def tracker(
    real: Real = None,
    sequence: Names = None,
    ablation: Ablation = False,
    fit_noise: FitNoise = False,
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
    """
    from eval import console
    from eval.benchmark.ground_real import default_folder
    from eval.benchmark.kitti_tracks import drives, read_drive
    from eval.benchmark.table import rich_table
    from eval.benchmark.tracker_noise import noise_table
    from eval.benchmark.tracker_report import score, shown, write
    from eval.output import refuse_existing

    if out is not None:
        refuse_existing(out, force)
    folder = (real or default_folder()) / "real" / "tracks"
    played = [read_drive(folder, name) for name in sequence or drives(folder)]
    screen = console.stdout()
    if fit_noise:
        screen.print(rich_table(noise_table(played)))
        return
    scores, without = score(played, ablation)
    for rows in shown(scores, without):
        screen.print(rich_table(rows))
    if out is not None:
        write(scores, without, out, force)
        screen.print(f"written: {out}", markup=False)
