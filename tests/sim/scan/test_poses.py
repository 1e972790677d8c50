from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from datmo.errors import SimulationError
from sim.scan.motion import sweep_motion
from sim.scan.pattern import pattern
from sim.scan.units import unit
from sim.scene.motion import edges

GRID = pattern(unit("hdl64e-utexas"), 10)


def test_edges_cover_the_sweep_in_blocks_of_32_columns() -> None:
    time = edges(2083, 0.1)
    assert len(time) == int(np.ceil(2083 / 32)) + 1
    assert time[0] == -0.1
    assert time[-1] == 0
    np.testing.assert_allclose(np.diff(time)[:-1], 0.1 * 32 / 2083)
    assert len(edges(64, 0.1)) == 3


def test_pose_of_a_column_is_that_of_its_own_time(kit: SimpleNamespace) -> None:
    """Against the motion itself, evaluated at the column's time: within a tenth of a millimetre at 80 m."""

    def ego(t: float) -> Any:
        return kit.at(20 * t + 3 * t * t, 2 * t, 0.0, 1.2 * t, 0.3 * t)

    motion = sweep_motion(GRID, kit.poses_of(GRID, ego, []), np.eye(4))
    for column in (0, 31, 32, 1000, 2081, 2082):
        want = ego(float(GRID.time[column]))
        far = np.array([80.0, 0, 0, 1])
        np.testing.assert_allclose(motion.T_world_sensor[column] @ far, want @ far, atol=1e-4)
    np.testing.assert_allclose(motion.T_stamp_sensor[-1], np.eye(4), atol=1e-12)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("T_world_ego", np.zeros((3, 4, 4))),
        ("velocity", np.zeros((1, 2))),
        ("velocity", np.full((2, 2), np.nan)),
        ("asset", ("car",)),
    ],
)
def test_poses_that_do_not_fit_are_refused(kit: SimpleNamespace, name: str, value: Any) -> None:
    two = [("car", lambda _: np.eye(4)), ("ped", lambda _: np.eye(4))]
    poses = kit.poses_of(GRID, lambda _: np.eye(4), two)
    with pytest.raises(SimulationError, match=f"Poses.{name}"):
        replace(poses, **{name: value})
