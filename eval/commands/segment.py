"""datmo segment: ground of a cloud file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eval.commands import options as o

if TYPE_CHECKING:
    from datmo.arrays import Array


def segment(
    cloud: Annotated[Path, typer.Argument(metavar="FILE.bin", help="float32 x, y, z, intensity (KITTI).")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE.label", help="Where the labels go.")],
    method: Annotated[str | None, typer.Option("--method", help="Ground method.")] = None,
    picture: o.Picture = None,
    force: o.Force = False,
) -> None:
    """Tell ground from the rest in a lidar scan.

    Writes one uint32 for each point of the file, as SemanticKITTI does: 40 (road) for ground, 99
    (other-object) for what stands on it, 0 (unlabelled) for points with NaN, which are left out
    and counted.

    \b
    Examples:
      datmo segment scan.bin --out scan.label
      datmo segment scan.bin --method zl --out scan.label --picture ground.png
    """
    from datmo.config import DatmoConfig
    from datmo.ground import segment_ground
    from datmo.refine import refine
    from eval import clouds
    from eval.output import refuse_existing, write_file
    from eval.report.recording import encode
    from eval.view import ground_eye

    for path in (out, picture):
        if path is not None:
            refuse_existing(path, force)
    read = clouds.read_bin(cloud)
    config = DatmoConfig() if method is None else DatmoConfig().with_ground(method)
    keep = refine(read.scan, config.refine)
    ground = segment_ground(read.scan.points, config=config.ground, keep=keep)
    label = clouds.labels(ground.is_ground, read.kept)
    write_file(out, clouds.label_bytes(label), force)
    if picture is not None:
        write_file(picture, encode(ground_eye(read.scan, ground.is_ground), "PNG"), force)
    tell_counts(label, out)


def tell_counts(label: Array, out: Path) -> None:
    """Print how many points have each label, and where the labels are."""
    import numpy as np

    from eval import clouds, console

    rows = [("ground", clouds.ROAD), ("not ground", clouds.OTHER_OBJECT), ("dropped", clouds.UNLABELLED)]
    counts = [(name, code, int(np.count_nonzero(label == code))) for name, code in rows]
    screen = console.stdout()
    screen.print(console.count_table(counts))
    if counts[-1][2]:
        screen.print(f"{counts[-1][2]} points with NaN or infinite coordinates have label 0")
    screen.print(f"labels: {out}", markup=False)
