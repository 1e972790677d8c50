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
    """Trackers on the cars of KITTI tracking sequences, scored by TrackEval on 3-D overlap.

    Ours tuned for such detections and as it comes, with and without what coasts; ours as the thesis
    has it; a plain Kalman filter in the world. With --out, leaves tracker.json and tracker.md in DIR.

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
    from eval.benchmark.tracker_ablation import ablate
    from eval.benchmark.tracker_real import score_real
    from eval.benchmark.tracker_report import table, write
    from eval.benchmark.tracker_rivals import POINT_RCNN, rivals
    from eval.output import refuse_existing

    if out is not None:
        refuse_existing(out, force)
    folder = (real or default_folder()) / "real" / "tracks"
    played = [read_drive(folder, name) for name in sequence or drives(folder)]
    screen = console.stdout()
    if fit_noise:
        from dataclasses import fields

        from datmo.tracks import TrackerConfig
        from eval.benchmark.tracker_noise import Noise, noise_table, residuals
        from eval.benchmark.tracker_noise import fit_noise as fit

        config = TrackerConfig()
        used = Noise(**{f.name: getattr(config, f.name) for f in fields(Noise)})
        screen.print(rich_table(noise_table(fit(residuals(played)), used)))
        return
    scores = score_real(rivals(), played)
    screen.print(rich_table(table("real sequences", {name: each["all"] for name, each in scores.items()})))
    without = ablate(POINT_RCNN, played) if ablation else {}
    if without:
        screen.print(rich_table(table("ablation", without)))
    if out is not None:
        write(scores, without, out, force)
        screen.print(f"written: {out}", markup=False)
