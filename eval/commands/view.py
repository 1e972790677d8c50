"""datmo view: a run as a film or a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eval.commands import options as o


def view(
    scenario: o.Scenario,
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="film.gif, film.mp4 or picture.png.")],
    seed: o.Seed = 0,
    frames: o.Frames = None,
    ground: o.GroundMethod = None,
    set_: o.Settings = None,
    pixels: Annotated[int, typer.Option("--pixels", min=100, max=2000, help="Side of the picture.")] = 800,
    radius: Annotated[float, typer.Option("--radius", min=5, max=120, help="Half its extent [m].")] = 50.0,
    force: o.Force = False,
) -> None:
    """Draw a scenario from above, as a film.

    Cloud by class, true boxes, tracks with tails.

    A .png is the picture of the last scan; .mp4 needs the extra "video".

    \b
    Examples:
      datmo view rough-crossing --out film.gif
      datmo view rough-crossing --seed 7 --frames 40 --radius 30 --out scan40.png
    """
    from eval import console, film
    from eval.output import refuse_existing, write_file
    from scenarios.load import load

    film.check(out)
    refuse_existing(out, force)
    what = load(scenario, o.settings(set_))
    with console.progress(what.name, min(frames or what.scans, what.scans)) as tell:
        shots = film.shoot(
            what, seed, frames, ground, radius, pixels, out.suffix == ".png", console.on_step(tell)
        )
    write_file(out, film.develop(shots, out.suffix, what.rate), force)
    console.stdout().print(f"{len(shots)} pictures: {out}", markup=False)
