from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from datmo.boxes.rectangle import search
from datmo.errors import ConfigError
from datmo.messages import Scan
from eval.benchmark.boxes import (
    CHANGED,
    FIT,
    REPEATS,
    RIVAL,
    STAGES,
    Result,
    Sweep,
    benchmark_boxes,
    python_loop,
)
from eval.benchmark.boxes_table import ratio, shown
from eval.cli import BAD_INPUT, DONE, call
from scenarios.load import dump, load
from scenarios.spec import Scenario


def ell(rng: np.random.Generator) -> np.ndarray:
    """Two noisy sides of a rectangle (60, 2), turned and moved."""
    length, width, yaw = rng.uniform(2, 8), rng.uniform(0.6, 2.5), rng.uniform(-np.pi, np.pi)
    long = np.column_stack([rng.uniform(0, length, 40), np.zeros(40)])
    short = np.column_stack([np.zeros(20), rng.uniform(0, width, 20)])
    points = np.concatenate([long, short]) + rng.normal(0, 0.02, (60, 2))
    c, s = np.cos(yaw), np.sin(yaw)
    return points @ np.array([[c, s], [-s, c]]) + rng.uniform(-40, 40, 2)


def result(fit: float = 5.0) -> Result:
    times = {"refine": (2.0, 3.0), "cluster": (1.5, 1.0), FIT: (fit, fit + 1), RIVAL: (401.0, 400.0)}
    return Result("s", 1000, 500, 101, 40, times)


def test_the_rival_finds_the_same_angles() -> None:
    rng = np.random.default_rng(0)
    points = np.array([ell(rng) for _ in range(30)])
    ours = search(points, np.full(30, 60), np.deg2rad(1), 0.05, "closeness", (0, 1, 0))
    theirs = python_loop(points.reshape(-1, 2), np.arange(31) * 60)
    np.testing.assert_allclose(theirs, ours, atol=1e-12)


def test_the_best_of_the_rounds_is_told_and_judged() -> None:
    assert (result().total, ratio(result())) == (8.0, 80.0)
    cost, beside = shown([result(), result(fit=20.0)])
    assert cost.rows[0] == ("s", "1000", "101", "40", "2.00", "1.00", "5.00", "8.00", "yes")
    assert cost.rows[1][-2:] == ("23.00", "no")
    assert beside.rows[0] == ("s", "500", "5.00", "400", "80", "yes", "50")
    assert beside.rows[1][-2] == "no"
    for table in (cost, beside):
        assert all(len(row) == len(table.heads) for row in table.rows)


def test_the_command_leaves_its_files(
    tiny: Scenario, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario, out = tmp_path / "tiny.yaml", tmp_path / "out"
    scenario.write_text(dump(tiny))
    asked = ["benchmark", "boxes", str(scenario), "--rounds", "2", "--out", str(out)]
    assert call(asked) == DONE
    assert RIVAL in capsys.readouterr().out
    written = json.loads((out / "boxes.json").read_text())
    assert written["settings"] == {"sweeps": [f"{scenario}, seed 0"], "rounds": 2}
    assert {"processor", "cores"} <= set(written["hardware"])
    (found,) = written["results"]
    assert set(found["times"]) == {*STAGES, RIVAL}
    assert len(found["times"].pop(RIVAL)) == 2
    assert all(len(times) == 2 * REPEATS and min(times) > 0 for times in found["times"].values())
    assert 0 < found["boxes"] <= found["clusters"] <= found["clustered"] < found["points"]
    page = (out / "boxes.md").read_text()
    assert f"| {scenario}, seed 0 |" in page
    assert "- processor: " in page
    assert call(asked) == BAD_INPUT  # results are not overwritten


def block(at: tuple[float, float]) -> np.ndarray:
    """A wall of points on a flat ground (n, 3) around a sensor 1.7 m up."""
    y, z = np.meshgrid(np.linspace(-1, 1, 21), np.linspace(-1.2, 0.3, 16))
    return np.column_stack([np.full(y.size, at[0]), at[1] + y.ravel(), z.ravel()])


def test_cloud_files_are_measured_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    turn, reach = np.meshgrid(np.linspace(-np.pi, np.pi, 720, endpoint=False), np.linspace(3, 30, 40))
    flat = np.column_stack([(reach * np.cos(turn)).ravel(), (reach * np.sin(turn)).ravel()])
    ground = np.column_stack([flat, np.full(len(flat), -1.7)])
    points = np.concatenate([ground, block((10, 5)), block((15, -6))])
    cloud = tmp_path / "cloud.bin"
    np.column_stack([points, np.zeros(len(points))]).astype("<f4").tofile(cloud)
    assert call(["benchmark", "boxes", "--cloud", str(cloud), "--rounds", "1"]) == DONE
    assert "cloud.bin" in capsys.readouterr().out
    assert call(["benchmark", "boxes", "--cloud", str(tmp_path / "none.bin")]) == BAD_INPUT


def test_the_crowded_street_is_a_scenario_still() -> None:
    for changes in CHANGED.values():
        assert load("city-street", changes) != load("city-street")


def test_what_cannot_be_measured_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nothing = Sweep("nothing", Scan(points=np.array([[5.0, 0, -1.7]], np.float32)))
    with pytest.raises(ConfigError, match="give 1 or more"):
        benchmark_boxes(nothing, 0)
    with pytest.raises(ConfigError, match="no cluster"):
        benchmark_boxes(nothing, 1)
    cloud = tmp_path / "one.bin"
    np.zeros((1, 4), "<f4").tofile(cloud)
    assert call(["benchmark", "boxes", "--cloud", str(cloud), "--rounds", "0"]) == BAD_INPUT
    assert "give 1 or more" in capsys.readouterr().err
