"""Two published ground segmentations, as they come: Patchwork++ and linefit. They only give labels.

Patchwork++: Lee, Lim, Myung, IROS 2022 (package pypatchworkpp), its own parameters, the sensor's height
given. linefit: Himmelsbach, von Hundelshausen, Wuensche, IV 2010 (package linefit), its built-in
parameters, which are made for KITTI's HDL-64E.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

import numpy as np

from datmo.arrays import Bool
from datmo.messages import Ground, Plane, Scan
from eval.benchmark.ground_methods import Contestant, Step

RIVAL = "patchwork++"
"""The one that times and labels are held against."""
HEIGHT = 1.73
NOWHERE = Plane(np.nan, np.nan, np.nan, np.nan)


def labelled(is_ground: Bool) -> Ground:
    """Labels without heights."""
    unknown = np.full(len(is_ground), np.nan, np.float32)
    return Ground(is_ground, unknown, unknown, NOWHERE)


def patchwork() -> Step:
    """Patchwork++; as it adapts its thresholds over a sequence, each scene gets a fresh one."""
    import pypatchworkpp

    parameters = pypatchworkpp.Parameters()
    parameters.sensor_height, parameters.verbose = HEIGHT, False
    with quiet():
        peer = pypatchworkpp.patchworkpp(parameters)

    def step(scan: Scan) -> Ground:
        peer.estimateGround(np.column_stack([scan.points, scan.intensity]))
        is_ground = np.zeros(len(scan), bool)
        is_ground[np.asarray(peer.getGroundIndices(), np.int64)] = True
        return labelled(is_ground)

    return step


def linefit() -> Step:
    """linefit."""
    from linefit import ground_seg

    with quiet():
        peer = ground_seg()
    return lambda scan: labelled(np.asarray(peer.run(scan.points), bool))


PEERS = ((RIVAL, "pypatchworkpp", patchwork), ("linefit", "linefit", linefit))


def peers() -> tuple[list[Contestant], list[str]]:
    """The peers that are installed, and a note on each that is not."""
    found, notes = [], []
    for name, package, fresh in PEERS:
        if find_spec(package) is None:
            notes.append(f"{name} is left out: {package} is not installed; pip install {package}")
        else:
            found.append(Contestant(name, fresh, ours=False))
    return found, notes


@contextmanager
def quiet() -> Iterator[None]:
    """Keep what native code prints out of our results."""
    sys.stdout.flush()
    kept, nothing = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nothing, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nothing)
