from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from datmo.errors import ConfigError
from datmo.ground import METHODS, GroundConfig, segment_ground
from datmo.messages import Ground, Kind, Plane, Relief, Scan
from eval.benchmark import ground, ground_grid, ground_peers
from eval.benchmark.ground_ablation import ABLATIONS, costs
from eval.benchmark.ground_figures import COVERAGE, NAMES, figures
from eval.benchmark.ground_grid import Row, in_turn, play
from eval.benchmark.ground_methods import Contestant, ours
from eval.benchmark.ground_peers import peers
from eval.benchmark.ground_scenes import Scene
from eval.benchmark.ground_table import tables
from eval.benchmark.ground_verdict import is_hard, verdict
from eval.cli import BAD_INPUT, DONE, call
from eval.metrics.ground import grid_centres

PEER_NAMES = ["patchwork++", "linefit"]


@pytest.fixture
def scene(stage: Any) -> Scene:
    """A level ground 1.73 m below the sensor, a car, a truck and a walker on it."""
    frame, truth = stage(0)
    xy = grid_centres()
    relief = Relief(xy, np.full(len(xy), -1.73), np.ones(len(xy), bool), np.full(len(xy), Kind.ROAD))
    return Scene("A-0", "A", 0.0, frame.scan, truth, relief)


@pytest.fixture
def staged_scenes(monkeypatch: pytest.MonkeyPatch, scene: Scene) -> None:
    """The command meets hand-made scenes, and no real sweeps unless told."""

    def made(classes: Any, grades: Any, seed: int, scans: int, tell: Any) -> Iterator[Scene]:
        for c in classes:
            for g in grades:
                yield Scene(f"{c}-{g:g}", c, g, scene.scan, scene.truth, scene.relief)

    monkeypatch.setattr(ground, "scenes", made)
    monkeypatch.setenv("DATMO_REAL_DATA", "/nowhere")


def called(scene: Scene, wrong: int, std: float, bias: float) -> Ground:
    """The true labels, but `wrong` points of the car called ground; a plane that is off by `bias`."""
    is_ground = scene.truth.is_ground.copy()
    is_ground[np.flatnonzero(scene.truth.actor == 0)[:wrong]] = True
    n = len(is_ground)
    return Ground(is_ground, np.full(n, -1.73), np.full(n, std), Plane(c=-1.73 + bias, std=std))


def test_figures_of_a_hand_computed_case(scene: Scene) -> None:
    got = figures(scene.scan, called(scene, 20, 0.05, 0.08), scene.truth, scene.relief, True)
    r = np.hypot(*scene.scan.points[:, :2].T)
    true, soft = scene.truth.is_ground & (r <= 50), (scene.truth.actor >= 0) & (r <= 50)
    assert got["precision"] == pytest.approx(true.sum() / (true.sum() + 20))
    assert got["recall"] == got["obstacle_precision"] == 1.0
    assert got["f1"] == pytest.approx(2 * true.sum() / (2 * true.sum() + 20))
    assert got["leak"] == pytest.approx(20 / soft.sum())
    assert got["height_rmse"] == pytest.approx(0.08, rel=1e-5)
    assert got["height_rmse_unseen"] == pytest.approx(0.08, rel=1e-5)
    assert got["smse"] is None  # a level truth has no variance
    assert {got[name] for name in (*COVERAGE["seen"], *COVERAGE["unseen"])} == {1.0}
    surer = figures(scene.scan, called(scene, 0, 0.04, 0.08), scene.truth, scene.relief, True)
    assert {surer[name] for name in (*COVERAGE["seen"], "coverage95", "coverage95_unseen")} == {0.0}
    labels = figures(scene.scan, called(scene, 0, 0.04, 0.08), scene.truth, scene.relief, False)
    assert labels["f1"] == 1.0
    assert labels["height_rmse"] is labels["coverage95"] is None
    assert list(labels) == list(NAMES)


def test_coverage_is_told_band_by_band(scene: Scene) -> None:
    tilted = Ground(scene.truth.is_ground, np.zeros(len(scene.scan)), np.zeros(len(scene.scan)), Cone())
    got = figures(scene.scan, tilted, scene.truth, scene.relief, True)
    assert [got[name] for name in COVERAGE["seen"]] == [1.0, 1.0, 0.0, 0.0, 0.0]


class Cone(Plane):
    """Right up to 20 m, and a metre off beyond."""

    def __call__(self, xy: Any) -> Any:
        far = np.hypot(xy[:, 0], xy[:, 1]) >= 20
        return np.where(far, -0.73, -1.73), np.full(len(xy), 0.05)


def test_peers_label_every_point_and_the_same_ones_each_time(capfd: pytest.CaptureFixture[str]) -> None:
    r, azimuth = np.repeat(np.geomspace(3, 45, 60), 720), np.tile(np.linspace(-np.pi, np.pi, 720), 60)
    level = np.column_stack([r * np.cos(azimuth), r * np.sin(azimuth), np.full(len(r), -1.73)])
    wall = np.column_stack(
        [np.full(2000, 12.0), np.tile(np.linspace(-3, 3, 100), 20), np.repeat(np.linspace(-1, 1, 20), 100)]
    )
    scan, true = Scan(points=np.vstack([level, wall])), np.arange(len(r) + 2000) < len(r)
    found, notes = peers()
    assert [c.name for c in found] == PEER_NAMES
    assert notes == []
    for contestant in found:
        one, two = (contestant.fresh()(scan) for _ in range(2))
        assert len(one) == len(scan)
        assert one == two
        assert np.isnan(one.surface(np.zeros((1, 2)))).all()
        assert (one.is_ground == true).mean() > 0.95
    assert capfd.readouterr().out == ""


def test_an_absent_peer_is_left_out_with_a_note(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ground_peers, "find_spec", lambda name: None if name == "linefit" else name)
    found, notes = peers()
    assert [c.name for c in found] == PEER_NAMES[:1]
    assert notes == ["linefit is left out: linefit is not installed; pip install linefit"]


def test_contestants_are_interleaved_and_judged_by_their_first_result(scene: Scene) -> None:
    met: list[str] = []

    def contestant(name: str) -> Contestant:
        def fresh() -> Any:
            state = iter(range(100))

            def step(scan: Scan) -> Ground:
                met.append(name)
                return called(scene, 10 * next(state), 0.1, 0.0)

            return step

        return Contestant(name, fresh)

    grounds, times = in_turn([contestant("a"), contestant("patchwork++")], scene.scan, 2)
    assert met == ["a", "patchwork++"] * 3
    assert times.shape == (3, 2)
    assert np.array_equal(grounds[0].is_ground, scene.truth.is_ground)
    rows = play([contestant("a"), contestant("patchwork++")], [scene], 3)
    assert [row.method for row in rows] == ["a", "patchwork++"]
    assert rows[1].figures["ratio"] == 1.0
    assert rows[0].figures["leak"] == 0.0
    alone = play([contestant("a")], [scene], 1)
    assert alone[0].figures["ratio"] is None


def test_our_rows_are_those_of_segment_ground_and_do_not_depend_on_rounds(scene: Scene) -> None:
    one, two = (play([ours(METHODS[0])], [scene], rounds)[0].figures for rounds in (1, 2))
    kept = [name for name in NAMES if name not in ("ms", "ms_first", "ratio")]
    assert {n: one[n] for n in kept} == {n: two[n] for n in kept}
    own = segment_ground(scene.scan.points, METHODS[0])
    want = figures(scene.scan, own, scene.truth, scene.relief, True)
    assert {n: one[n] for n in kept} == {n: want[n] for n in kept}


def _row(scene: str, method: str, f1: float, leak: float | None) -> Row:
    roughness, grade = scene.split("-")
    return Row(scene, roughness, float(grade), method, dict.fromkeys(NAMES) | {"f1": f1, "leak": leak})


def test_the_verdict_asks_for_both_on_hard_scenes_and_for_little_on_the_others() -> None:
    hard = [("C", 5.0), ("D", 0.0), ("0.1", 0.0)]
    assert [pair for pair in [("C", 0.0), ("flat", 0.0), ("0.01", 0.0), *hard] if is_hard(*pair)] == hard
    ours_and_theirs = {
        "D-0": ((0.99, 0.01), (0.98, 0.02)),  # better in both
        "E-0": ((0.99, 0.03), (0.98, 0.02)),  # leaks more
        "A-5": ((0.98, 0.01), (0.98, 0.02)),  # no better F1
        "F-0": ((0.99, None), (0.98, None)),  # nothing that could leak
        "A-0": ((0.9971, 0.5), (1.0, 0.0)),  # within 0.3
        "B-0": ((0.9969, 0.0), (1.0, 0.0)),  # not
    }
    rows = [
        _row(scene, method, *got)
        for scene, both in ours_and_theirs.items()
        for method, got in zip(("z", "patchwork++"), both, strict=True)
    ]
    found = verdict(rows, "z")
    assert found is not None
    assert (found.hard, found.won, found.easy, found.held) == (4, 2, 2, 1)
    assert found.short == ("E-0", "A-5", "B-0")
    assert "2 of 4" in str(found)
    assert verdict(rows, "zl") is None
    assert verdict([row for row in rows if row.method == "z"], "z") is None


def test_many_scenes_are_shown_as_means() -> None:
    rows = [_row(f"{c}-{g}", "z", f, 0.0) for f, c in ((0.9, "A"), (0.8, "B")) for g in (0, 5, 10, 15, 20)]
    by_class, by_grade, every = tables(rows)
    assert [row[:3] for row in by_class.rows] == [("A", "z", "90.00"), ("B", "z", "80.00")]
    assert [row[0] for row in by_grade.rows] == ["0 %", "5 %", "10 %", "15 %", "20 %"]
    assert every.rows[0][2] == "85.00"


def test_an_ablation_tells_what_changes() -> None:
    rows = [_row("A-0", "z", 0.99, 0.01), _row("A-0", "without refit", 0.97, 0.04)]
    (whole, own), (name, change) = costs(rows)
    assert (whole, own["f1"], name) == ("z", 0.99, "without refit")
    assert change["f1"] == pytest.approx(-0.02)
    assert change["leak"] == pytest.approx(0.03)
    assert change["height_rmse"] is None
    for overrides in ABLATIONS.values():
        fields = GroundConfig().model_dump()
        assert GroundConfig.model_validate({**fields, **overrides}) != GroundConfig()


@pytest.mark.long
def test_the_command_leaves_its_files(
    staged_scenes: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "ground"
    asked = ["benchmark", "ground", "--classes", "A,E", "--grades", "0,10", "--methods", "z", "--rounds", "1"]
    assert call([*asked, "--out", str(out)]) == DONE
    said = capsys.readouterr().out
    assert "real sweeps are left out" in said
    assert "better than patchwork++" in said
    record = json.loads((out / "ground.json").read_text())
    assert len(record["rows"]) == 4 * 3
    assert record["settings"]["classes"] == ["A", "E"]
    assert {"processor", "cores"} <= set(record["hardware"])
    with (out / "ground.csv").open() as file:
        table = list(csv.DictReader(file))
    assert [row["scene"] for row in table[:4]] == ["A-0", "A-0", "A-0", "A-10"]
    assert [row["method"] for row in table[:3]] == ["z", *PEER_NAMES]
    assert float(table[0]["f1"]) == pytest.approx(record["rows"][0]["figures"]["f1"], rel=1e-5)
    assert table[1]["height_rmse"] == ""
    assert (out / "ground.md").read_text().count("\n| A-0 |") == 3
    assert (out / "ground.png").read_bytes().startswith(b"\x89PNG")
    assert call([*asked, "--out", str(out)]) == BAD_INPUT  # results are not overwritten


@pytest.mark.long
def test_the_ablation_of_a_method(staged_scenes: None, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["benchmark", "ground", "--ablation", "--classes", "A", "--grades", "0", "--rounds", "1"]
    assert call([*asked, "--methods", "z"]) == DONE
    said = capsys.readouterr().out
    assert all(f"without {name}" in said for name in ABLATIONS)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (["--classes", "A,J"], "class 'J'"),
        (["--classes", ","], "--classes ',' names nothing; give"),
        (["--grades", "steep"], "write e.g. 0,5,10"),
        (["--grades", "90"], "give 0 to 30"),
        (["--methods", "y"], "ground method 'y' is not known"),
        (["--rounds", "0"], "rounds is 0"),
        (["--ablation", "--table51"], "give one of them"),
        (["--ablation", "--methods", "z,z-se"], "give one"),
        (["--classes", "A", "--real", "/nowhere"], "--real /nowhere: no sweep there; give"),
    ],
)
def test_bad_input_is_one_line(
    staged_scenes: None, wrong: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(["benchmark", "ground", *wrong]) == BAD_INPUT
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1


def test_no_round_is_refused(scene: Scene) -> None:
    with pytest.raises(ConfigError, match="rounds is 0"):
        ground_grid.play([ours("z")], [scene], 0)
