"""Refine beside the statistical outlier filter of a k-d tree, on simulated and real sweeps.

The tree drops points whose mean distance to their 8 nearest neighbours is beyond mean + 6 std (as PCL's
StatisticalOutlierRemoval does), a length in metres: it thins out what is far, where even a wall has wide
gaps. Refine counts in shares of the range and looks along the ring only, so it drops edges that one ring
alone meets.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree

from datmo.messages import Scan
from datmo.refine import RefineConfig, refine
from scenarios.spec import Scenario
from sim.env import LidarEnv

NEIGHBOURS, DEVIATIONS = 8, 6.0
ALONE = 2.5  # [m] a planted return has no other one within this


def tree_filter(points: np.ndarray) -> np.ndarray:
    """Which points (n,) the tree keeps."""
    distance = cKDTree(points).query(points, NEIGHBOURS + 1)[0][:, 1:].mean(1)
    return distance <= distance.mean() + DEVIATIONS * distance.std()


def both(scan: Scan) -> tuple[Scan, np.ndarray, np.ndarray]:
    """The scan within the radii, and which of its points refine and the tree keep."""
    inside = refine(scan, RefineConfig(neighbours=0))
    scan = Scan(points=scan.points[inside], ring=scan.ring[inside])
    return scan, refine(scan), tree_filter(scan.points.astype(float))


def plant(scan: Scan, rng: np.random.Generator) -> tuple[Scan, np.ndarray]:
    """A hundred returns moved into the open air, as of birds or drops, and which are alone there (m,)."""
    points = scan.points.astype(float)
    rows = rng.choice(len(points), 100, replace=False)
    azimuth, rise = np.arctan2(points[rows, 1], points[rows, 0]), rng.uniform(0.4, 0.9, 100)
    ahead = np.column_stack([np.cos(azimuth) * np.cos(rise), np.sin(azimuth) * np.cos(rise), np.sin(rise)])
    points[rows] = rng.uniform(8, 25, (100, 1)) * ahead
    nearest = cKDTree(points).query(points[rows], 2)[0][:, 1]
    return Scan(points=points, ring=scan.ring), rows[nearest > ALONE]


@cache
def simulated(text: str) -> Scan:
    scan: Scan = LidarEnv(Scenario.model_validate_json(text)).reset(seed=3)[1]["scan"]
    return scan


def test_on_a_simulated_sweep_both_drop_what_is_alone_and_keep_surfaces(tiny: Scenario) -> None:
    clean, ours, tree = both(simulated(tiny.model_dump_json()))
    assert ours.mean() >= 0.99
    assert tree.mean() >= 0.99
    assert np.mean(ours & tree) >= 0.99
    assert np.mean(ours == tree) >= 0.99
    planted, rows = plant(clean, np.random.default_rng(0))
    _, ours_now, tree_now = both(planted)
    assert len(rows) >= 50
    assert np.mean(~ours_now[rows]) >= 0.95
    assert np.mean(~tree_now[rows]) >= 0.95
    rest = np.setdiff1d(np.arange(len(clean)), rows)
    assert np.mean(ours_now[rest]) >= 0.99
    assert np.mean(tree_now[rest]) >= 0.99


@pytest.mark.parametrize("frame", ["000000", "000001", "000002"])
def test_on_a_real_sweep_both_agree_but_for_what_is_far_or_on_edges(real_data, frame: str) -> None:
    path = real_data / "real" / "frames" / f"{frame}.bin"
    scan, ours, tree = both(Scan(points=np.fromfile(path, np.float32).reshape(-1, 4)[:, :3]))
    reach = np.linalg.norm(scan.points, axis=1)
    assert np.mean(ours == tree) >= 0.99
    assert np.mean(ours & tree) >= 0.99
    assert np.median(reach[ours & ~tree]) > 2 * np.median(reach)
    assert 0.1 * np.sum(~ours) <= np.sum(
        ~ours & ~tree
    )  # most of what refine drops has neighbours off its ring
