from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pypatchworkpp
import pytest

from datmo.ground import METHODS, segment_ground

DATA = Path(os.environ.get("DATMO_REAL_DATA", Path(__file__).parents[4] / "shared" / "data"))
FRAMES = sorted((DATA / "real" / "frames").glob("*.bin"))
pytestmark = pytest.mark.skipif(not FRAMES, reason=f"no real frames under {DATA}")


def patchwork(points: np.ndarray) -> np.ndarray:
    parameters = pypatchworkpp.Parameters()
    parameters.verbose = False
    peer = pypatchworkpp.patchworkpp(parameters)
    peer.estimateGround(np.column_stack([points, np.zeros(len(points))]).astype(np.float32))
    ground = np.zeros(len(points), bool)
    ground[peer.getGroundIndices()] = True
    return ground


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("path", FRAMES, ids=[p.stem for p in FRAMES])
def test_agrees_with_patchwork(path: Path, method: str) -> None:
    points = np.fromfile(path, np.float32).reshape(-1, 4)[:, :3]
    ours, theirs = segment_ground(points, method).is_ground, patchwork(points)
    assert np.mean(ours == theirs) >= 0.96
    assert np.mean(theirs[ours]) >= 0.99  # where they differ, we are the stricter: feet of walls and cars


@pytest.mark.parametrize("roll", [False, True])
def test_a_slope_of_15_degrees_changes_little(roll: bool) -> None:
    points = np.fromfile(FRAMES[0], np.float32).reshape(-1, 4)[:, :3].astype(float)
    c, s = np.cos(np.radians(15)), np.sin(np.radians(15))
    R = np.array([[1, 0, 0], [0, c, -s], [0, s, c]] if roll else [[c, 0, s], [0, 1, 0], [-s, 0, c]])
    level, tilted = segment_ground(points).is_ground, segment_ground(points @ R.T).is_ground
    assert np.mean(level == tilted) >= 0.99
