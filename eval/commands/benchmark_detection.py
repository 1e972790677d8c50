"""datmo benchmark detection: clusters and boxes against the truth, by class, range and visibility."""

from __future__ import annotations

from typing import Annotated

import typer

from eval.commands import options as o

Names = Annotated[
    list[str] | None, typer.Argument(metavar="[SCENARIO]...", help="Names or YAML files; rough-crossing.")
]
Seeds = Annotated[int, typer.Option("--seeds", min=1, help="Episodes of each scenario.")]
First = Annotated[int, typer.Option("--seed", min=0, metavar="N", help="Seed of the first of them.")]
Ablation = Annotated[bool, typer.Option("--ablation", help="Also each idea switched off in turn.")]


def detection(
    scenarios: Names = None,
    seeds: Seeds = 3,
    first: First = 100,
    frames: o.Frames = None,
    ablation: Ablation = False,
    workers: o.Workers = 1,
    out: o.OutFolder = None,
    force: o.Force = False,
) -> None:
    """Detection against the truth: recall, corners, yaw, overlap, splits, merges, and what lost the rest.

    Objects with ten returns or more count. The tracker is in the loop, so that its predictions come
    back to the clusters. With --out, leaves detection.json, .md and .png (objects with their boxes) in DIR.

    \b
    Examples:
      datmo benchmark detection
      datmo benchmark detection rough-crossing city-street --seeds 5 --workers 2 --out runs/detection
      datmo benchmark detection --frames 30 --ablation
    """
    from eval import console
    from eval.benchmark.detection import ABLATIONS, benchmark_detection, drawn, shown, write
    from eval.benchmark.table import rich_table
    from eval.output import refuse_existing

    if out is not None:
        refuse_existing(out, force)
    names, numbers = scenarios or ["rough-crossing"], list(range(first, first + seeds))
    episodes = len(names) * seeds * (1 + (len(ABLATIONS) if ablation else 0))
    with console.progress("episodes", episodes) as tell:
        results = benchmark_detection(names, numbers, frames, ablation, workers, lambda n: tell(n, ""))
    screen = console.stdout()
    for table in shown(results):
        screen.print(rich_table(table))
        screen.print()
    if out is not None:
        asked = {"scenarios": names, "seeds": numbers, "frames": frames, "ablation": ablation}
        write(results, drawn(names, first, frames), asked, out, force)
        screen.print(f"written: {out}", markup=False)
