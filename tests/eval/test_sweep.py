from __future__ import annotations

import csv

import pytest

from datmo.errors import ConfigError, ScenarioError
from eval import sweep as s
from eval.console import sweep_table
from eval.report.sweep_figure import sweep_figure
from scenarios.expect import UNITS
from scenarios.load import dump
from scenarios.spec import Scenario


def made() -> s.Sweep:
    names = [n for n in UNITS if not n.startswith("speed.")]
    scores = []
    for row in range(4):
        base: dict[str, float | None] = dict.fromkeys(names, 0.1 * row)
        scores.append([base | {"recovery.rate": None}, base | {"recovery.rate": 0.5 if row else None}])
    points = [("A", "0"), ("A", "0.1"), ("E", "0"), ("E", "0.1")]
    return s.Sweep(("terrain.roughness", "terrain.grade"), points, [0, 3], scores)


def test_the_plan_is_the_product_and_its_seeds() -> None:
    over = {"terrain.grade": ["0", "0.1"], "terrain.roughness": ["A", "E", "G"]}
    jobs = s.plan("empty-road", over, seeds=[4, 5], settings={"rate": "5"})
    assert len(jobs) == 12
    assert {j.scenario.rate for j in jobs} == {5.0}
    said = [(j.scenario.terrain.grade, j.scenario.terrain.roughness, j.seed) for j in jobs[:5]]
    assert said == [(0, "A", 4), (0, "A", 5), (0, "E", 4), (0, "E", 5), (0, "G", 4)]
    with pytest.raises(ConfigError, match="zz"):
        s.plan("empty-road", over, ground="zz")


def test_pairs_and_seeds_are_read() -> None:
    assert s.parse_over(["a.b=1,2", "c=[1,2],{x: 1, y: 2}"]) == {
        "a.b": ["1", "2"],
        "c": ["[1,2]", "{x: 1, y: 2}"],
    }
    assert s.parse_seeds("3") == [3]
    assert s.parse_seeds("0,4,7") == [0, 4, 7]
    assert s.parse_seeds("2..4") == [2, 3, 4]
    for bad in ("", "a", "4..2", "1,1", "-1", "1.5"):
        with pytest.raises(ConfigError, match="seeds"):
            s.parse_seeds(bad)
    for pairs in (["a"], ["=1"], ["a="], ["a=1,,2"], ["a=1,1"], ["a=1", "a=2"], []):
        with pytest.raises(ConfigError):
            s.parse_over(pairs)


def test_means_leave_out_what_was_not_measured() -> None:
    assert made().mean(0, "recovery.rate") is None
    assert made().mean(1, "recovery.rate") == 0.5
    assert made().mean(2, "tracking.hota") == pytest.approx(0.2)


def test_tables_hold_every_row() -> None:
    rows = list(csv.DictReader(s.to_csv(made()).splitlines()))
    assert len(rows) == 8
    assert rows[3]["terrain.grade"] == "0.1"
    assert rows[3]["seed"] == "3"
    assert rows[2]["recovery.rate"] == ""
    assert not any(name.startswith("speed.") for name in rows[0])
    lines = s.to_markdown(made()).splitlines()
    assert len(lines) == 6
    assert {line.count("|") for line in lines} == {11}
    assert sweep_table(made()).row_count == 4


def test_the_figure_is_drawn_also_without_anything_to_measure() -> None:
    nothing = s.Sweep(("a",), [("1",), ("2",)], [0], [[dict.fromkeys(UNITS)], [dict.fromkeys(UNITS)]])
    for sweep in (made(), nothing):
        assert sweep_figure(sweep)[:4] == b"\x89PNG"


def test_a_wrong_value_is_said_before_anything_is_played() -> None:
    with pytest.raises(ScenarioError, match="Z"):
        s.plan("empty-road", {"terrain.roughness": ["A", "Z"]})


@pytest.mark.long
def test_workers_do_not_change_the_scores(tiny: Scenario, tmp_path) -> None:
    path = tmp_path / "tiny.yaml"
    path.write_text(dump(tiny))
    told: list[int] = []
    over = {"terrain.roughness": ["A", "G"]}
    jobs = s.plan(path, over, seeds=[1], frames=2)
    alone = s.sweep(jobs, over, [1], on_done=told.append)
    both = s.sweep(jobs, over, [1], workers=2, on_done=told.append)
    assert told == [1, 2, 1, 2]
    assert s.to_csv(alone) == s.to_csv(both)
    assert alone.scores[0] != alone.scores[1]
    s.write(alone, tiny, tmp_path / "out")
    names = ["config.yaml", "figure.png", "scores.csv", "table.md"]
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == names
