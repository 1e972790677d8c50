from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from datmo.errors import ConfigError
from eval.benchmark.cast import benchmark_cast, scene
from eval.cli import BAD_INPUT, DONE, call
from scenarios import spec
from sim.scan.sweep import Lidar
from sim.scene.terrain import build_terrain


@pytest.mark.long
def test_the_command_leaves_its_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "cast"
    asked = ["benchmark", "cast", "--actors", "0,3", "--cells", "100", "--rounds", "2", "--out", str(out)]
    assert call(asked) == DONE
    assert "ratio" in capsys.readouterr().out
    written = json.loads((out / "cast.json").read_text())
    assert written["triangles"] == 20000
    assert {"processor", "cores"} <= set(written["hardware"])
    assert "embreex" in written["versions"]
    none, three = written["points"]
    assert (none["actors"], none["caught"], three["actors"]) == (0, 0, 3)
    assert three["caught"] > 100
    for point in (none, three):
        assert point["low"] <= point["ratio"] <= point["high"]
        assert 0 < sum(point["stages"].values()) <= 1.2 * point["sweep_ms"] + 1
    assert (out / "cast.png").read_bytes().startswith(b"\x89PNG")
    assert call(asked) == BAD_INPUT  # results are not overwritten


@pytest.mark.parametrize(
    "wrong", [["--actors", "ten"], ["--actors", "-1"], ["--cells", "99"], ["--rounds", "0"]]
)
def test_impossible_numbers_are_refused(wrong: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["benchmark", "cast", *wrong]) == BAD_INPUT
    assert "give" in (said := capsys.readouterr().err) or "write" in said


def test_the_ring_stands_around_the_ego_and_moves() -> None:
    terrain = build_terrain(spec.Terrain(cell=2.0), (), (-100, -100, 100, 100), np.random.SeedSequence(1))
    lidar = Lidar(spec.Sensor(), 10.0, terrain, (), np.random.SeedSequence(2))
    poses = scene(lidar, terrain, 40)
    reach = np.linalg.norm(poses.T_world_actor[:, -1, :2, 3], axis=1)
    assert 5 < reach.min() < 15
    assert 65 < reach.max() <= 75
    path = poses.T_world_actor[:, :, :2, 3]
    travelled = np.linalg.norm(path[:, -1] - path[:, 0], axis=1)
    np.testing.assert_allclose(travelled, 0.1 * np.linalg.norm(poses.velocity, axis=1), atol=1e-9)
    assert len(set(poses.kind)) == 4


def test_no_numbers_are_refused() -> None:
    with pytest.raises(ConfigError):
        benchmark_cast(actors=())
