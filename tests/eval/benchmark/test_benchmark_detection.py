from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from datmo.config import DatmoConfig
from datmo.messages import Kind, Visibility
from eval.benchmark.detection import ABLATIONS, benchmark_detection, changed
from eval.benchmark.detection_table import figures, goals, tables
from eval.benchmark.sightings import Sighting
from eval.cli import BAD_INPUT, DONE, call
from eval.metrics.diagnosis import Stage
from scenarios.load import dump
from scenarios.spec import Scenario


def one(found: bool = True, **values: object) -> Sighting:
    """A visible car at 12 m."""
    usual = {
        "scenario": "s", "seed": 0, "scan": 0, "kind": int(Kind.CAR), "visibility": int(Visibility.VISIBLE),
        "distance": 12.0, "returns": 50, "found": found, "split": False, "merged": False,
        "stage": int(Stage.NONE if found else Stage.BOXES), "center_error": 0.2 if found else None,
        "corner_error": 0.1 if found else None, "yaw_error": 0.02 if found else None,
        "iou": 0.8 if found else None,
    }  # fmt: skip
    return Sighting(**{**usual, **values})  # type: ignore[arg-type]


def test_figures_are_shares_and_medians() -> None:
    rows = [one(corner_error=0.1), one(corner_error=0.3, split=True), one(corner_error=0.2), one(False)]
    number, recall, corner, _, _, split, merged, *lost = figures(rows)
    assert (number, recall, corner, split, merged) == (4, 0.75, pytest.approx(0.2), 0.25, 0)
    assert lost == [0, 0, 0, 0.25]
    assert figures([])[1:] == (None,) * 10


def test_tables_put_each_object_in_its_row() -> None:
    rows = [one(), one(kind=int(Kind.PEDESTRIAN), distance=40.0), one(distance=300.0)]
    by_class, by_range, by_sight = tables(rows)
    assert [row[:2] for row in by_class.rows] == [("car", "2"), ("pedestrian", "1"), ("all", "3")]
    assert [row[:2] for row in by_range.rows] == [
        ("10-20 m", "1"), ("40-60 m", "1"), ("60-80 m", "1"), ("all", "3"),
    ]  # fmt: skip
    assert [row[:2] for row in by_sight.rows] == [("visible", "3"), ("all", "3")]


def test_goals_ask_of_those_they_name() -> None:
    far = [one(False, distance=41.0), one(False, kind=int(Kind.PEDESTRIAN), distance=26.0)]
    heavy = one(False, visibility=int(Visibility.HEAVY), distance=41.0)
    got = {goal.name: goal for goal in goals([one(), *far, heavy])}
    assert got["recall of vehicles within 40 m"].value == 1
    assert got["recall of persons within 25 m"].met is None
    assert got["recall, heavy"].met is False
    assert got["yaw of visible vehicles, median error [deg]"].value == pytest.approx(np.rad2deg(0.02))
    assert got["IoU of visible cars, median"].met is True


@pytest.mark.parametrize("name", ABLATIONS)
def test_each_ablation_changes_what_it_names_and_nothing_else(name: str) -> None:
    config, usual = changed(ABLATIONS[name]), DatmoConfig()
    differ = {stage for stage in DatmoConfig.model_fields if getattr(config, stage) != getattr(usual, stage)}
    assert differ == set(ABLATIONS[name])


@pytest.mark.long
def test_the_command_leaves_its_files(
    tiny: Scenario, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario, out = tmp_path / "tiny.yaml", tmp_path / "out"
    scenario.write_text(dump(tiny))
    asked = ["benchmark", "detection", str(scenario), "--seeds", "1", "--frames", "3", "--out", str(out)]
    assert call(asked) == DONE
    assert "recall of vehicles within 40 m" in capsys.readouterr().out
    written = json.loads((out / "detection.json").read_text())
    assert written["settings"]["frames"] == 3
    rows = written["sightings"]
    assert {row["scan"] for row in rows} == {0, 1, 2}
    assert all(row["returns"] >= 10 and row["found"] == (row["corner_error"] is not None) for row in rows)
    assert all((row["stage"] == 0) == row["found"] for row in rows)
    assert (out / "detection.png").read_bytes().startswith(b"\x89PNG")
    assert call(asked) == BAD_INPUT  # results are not overwritten
    (again,) = benchmark_detection([str(scenario)], [100], 3)
    assert [vars(row) for row in again.rows] == rows


def test_nothing_to_play_is_refused() -> None:
    with pytest.raises(Exception, match="at least one of each"):
        benchmark_detection([], [0])
