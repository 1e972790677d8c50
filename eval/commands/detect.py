"""datmo detect: boxes in a cloud file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from datmo.arrays import I64
from datmo.messages import Boxes
from eval.commands import options as o


def detect(
    cloud: Annotated[Path, typer.Argument(metavar="FILE.bin", help="float32 x, y, z, intensity (KITTI).")],
    out: Annotated[Path, typer.Option("--out", metavar="boxes.json", help="Where the boxes go.")],
    ground: o.GroundMethod = None,
    picture: o.Picture = None,
    force: o.Force = False,
) -> None:
    """Find boxes in a lidar scan.

    Writes JSON: for each box center [m], size (length, width, height) [m] and yaw [rad] in the
    frame of the sensor (x forward, y left, z up), score, kind and points.

    \b
    Examples:
      datmo detect scan.bin --out boxes.json
      datmo detect scan.bin --out boxes.json --picture boxes.png
    """
    from datmo.config import DatmoConfig
    from datmo.pipeline import Datmo
    from eval import clouds
    from eval.output import refuse_existing, write_file
    from eval.report.recording import encode
    from eval.view import bird_eye

    for path in (out, picture):
        if path is not None:
            refuse_existing(path, force)
    read = clouds.read_bin(cloud)
    config = DatmoConfig() if ground is None else DatmoConfig().with_ground(ground)
    frame = Datmo(config).step(read.scan)
    points = clouds.cluster_sizes(frame.boxes, read.scan, frame.clusters)
    text = clouds.boxes_json(frame.boxes, points, cloud.name, read.dropped)
    write_file(out, text.encode(), force)
    if picture is not None:
        write_file(picture, encode(bird_eye(frame), "PNG"), force)
    tell_boxes(frame.boxes, points, read.dropped, out)


def tell_boxes(boxes: Boxes, points: I64, dropped: int, out: Path) -> None:
    """Print the nearest boxes and where all are."""
    from eval import console

    screen = console.stdout()
    screen.print(console.box_table(boxes, points))
    if len(boxes) > console.ROWS:
        screen.print(f"and {len(boxes) - console.ROWS} farther ones")
    if dropped:
        screen.print(f"{dropped} points with NaN or infinite coordinates were left out")
    screen.print(f"{len(boxes)} boxes: {out}", markup=False)
