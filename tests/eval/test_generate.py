from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from datmo.errors import ConfigError, OutputError
from eval.generate import generate, plan
from scenarios.spec import Scenario


def content(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_frames_go_on_with_the_next_seed(tiny: Scenario, tmp_path: Path) -> None:
    jobs = plan([tiny, tiny], 10, 5, "semantickitti", tmp_path)
    assert [(j.seed, j.scans, j.folder.name) for j in jobs] == [
        (5, 7, "00"),
        (6, 3, "01"),
        (5, 7, "02"),
        (6, 3, "03"),
    ]


def test_ground_agrees_in_the_world_whatever_the_workers(tiny: Scenario, tmp_path: Path) -> None:
    world = tiny.model_copy(update={"duration": 0.2})
    for name, workers in (("one", 1), ("two", 2)):
        assert generate([world], 5, 3, "semantickitti", tmp_path / name, workers) == [3, 2]
    assert content(tmp_path / "one") == content(tmp_path / "two")
    folder = tmp_path / "one" / "sequences" / "00"
    for interval in json.loads((folder / "hidden.json").read_text()):
        assert set(interval) == {"actor", "start", "end"}
        assert interval["end"] is None or 0 < interval["end"] - interval["start"] <= 0.2 + 1e-9
    Tr = np.loadtxt(str(folder / "calib.txt"), usecols=range(1, 13), skiprows=4).reshape(3, 4)
    Tr = np.vstack([Tr, [0, 0, 0, 1]])
    poses = np.loadtxt(folder / "poses.txt").reshape(-1, 3, 4)
    heights: list[dict[tuple[int, int], float]] = []
    for k in (0, 2):
        cloud = np.fromfile(folder / f"velodyne/00000{k}.bin", "<f4").reshape(-1, 4)[:, :3].astype(float)
        label = np.fromfile(folder / f"labels/00000{k}.label", "<u4") & 0xFFFF
        assert len(label) == len(cloud)
        near = np.isin(label, [40, 48, 72]) & (np.hypot(cloud[:, 0], cloud[:, 1]) < 15)
        T = np.linalg.inv(Tr) @ np.vstack([poses[k], [0, 0, 0, 1]]) @ Tr
        world_points = cloud[near] @ T[:3, :3].T + T[:3, 3]
        cells = np.floor(world_points[:, :2] / 0.5).astype(int)
        heights.append({})
        for cell in {tuple(c) for c in cells.tolist()}:
            inside = (cells == cell).all(1)
            if inside.sum() >= 5:
                heights[-1][cell] = float(np.median(world_points[inside, 2]))
    shared = heights[0].keys() & heights[1].keys()
    difference = [heights[0][c] - heights[1][c] for c in shared]
    assert len(shared) > 100
    assert abs(np.median(difference)) < 0.01
    assert np.quantile(np.abs(difference), 0.9) < 0.06


def test_refusals(tiny: Scenario, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="semantickitti"):
        generate([tiny], 1, 0, "nuscenes", tmp_path / "a")
    (tmp_path / "b").mkdir()
    with pytest.raises(OutputError, match="--force"):
        generate([tiny], 1, 0, "semantickitti", tmp_path / "b")
    assert not (tmp_path / "a").exists()
