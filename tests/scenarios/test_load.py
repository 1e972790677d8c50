from __future__ import annotations

from pathlib import Path

import pytest

from datmo.errors import ScenarioError
from scenarios.catalog import names
from scenarios.load import dump, load


def write(folder: Path, text: str, name: str = "it.yaml") -> Path:
    file = folder / name
    file.write_text(text)
    return file


def problem(folder: Path, text: str) -> str:
    file = write(folder, text)
    with pytest.raises(ScenarioError) as caught:
        load(file)
    message = str(caught.value)
    assert str(file) in message
    return message


@pytest.mark.parametrize("name", names())
def test_what_is_dumped_loads_back_equal(name: str, tmp_path: Path) -> None:
    scenario = load(name)
    assert load(write(tmp_path, dump(scenario))) == scenario
    assert scenario.name == name


def test_a_child_lies_over_its_parent(tmp_path: Path) -> None:
    write(tmp_path, "name: a\ntags: [x, y]\nterrain: {grade: 0.1, roughness: C}\nsummary: mine\n", "a.yaml")
    child = load(write(tmp_path, "name: b\nextends: a.yaml\ntags: [z]\nterrain: {grade: 0.2}\n", "b.yaml"))
    assert (child.name, child.summary, child.tags) == ("b", "mine", ("z",))
    assert (child.terrain.grade, child.terrain.roughness) == (0.2, "C")
    assert child.extends is None


def test_overrides_are_yaml_at_dotted_places() -> None:
    scenario = load(
        "rough-crossing",
        {
            "terrain.grade": "1e-2",
            "pedestrians.1.speed": "2",
            "expect.ground.f1.min": "0.5",
            "traffic.environment": "null",
        },
    )
    assert scenario.terrain.grade == 0.01
    assert scenario.pedestrians[1].speed == 2
    assert scenario.pedestrians[0] == load("rough-crossing").pedestrians[0]
    assert scenario.expect["ground.f1"].min == 0.5
    assert scenario.traffic.environment is None


@pytest.mark.parametrize(
    ("key", "value", "match"),
    [
        ("terrain.gradee", "0.1", r"--set: terrain.gradee = 0.1: .*did you mean 'grade'"),
        ("duration", "-1", r"--set: duration = -1: .*greater than 0"),
        ("pedestrians.99.speed", "1", "no element"),
        ("name.first", "a", "under the plain value"),
        ("terrain..grade", "1", "joined by dots"),
        ("terrain.grade", "[", "--set terrain.grade"),
        ("extends", "x", "in its file"),
    ],
)
def test_wrong_overrides(key: str, value: str, match: str) -> None:
    with pytest.raises(ScenarioError, match=match):
        load("rough-crossing", {key: value})


def test_every_problem_is_named_with_key_value_rule_and_remedy(tmp_path: Path) -> None:
    message = problem(
        tmp_path,
        "name: bad\nduration: -3\nrate: 10 Hz\nterrain: {roughnes: E, grade: 6%, roughness: Z}\n"
        "pedestrians: [{start: [0, 1], speed: true}]\ntrafic: 3\n",
    )
    lines = message.splitlines()
    expected = {
        "duration = -3": "greater than 0",
        "rate = '10 Hz'": "without a unit",
        "terrain.roughnes = 'E'": "did you mean 'roughness'",
        "terrain.grade = '6%'": "m/m",
        "terrain.roughness = 'Z'": "one of flat, A, B",
        "pedestrians.0.goal": "is missing",
        "pedestrians.0.speed = True": "must be a number",
        "trafic = 3": "did you mean 'traffic'",
    }
    assert len(lines) == len(expected)
    for start, rest in expected.items():
        assert any(f": {start}" in line and rest in line for line in lines), start


def test_a_problem_names_the_file_it_stands_in(tmp_path: Path) -> None:
    parent = write(tmp_path, "name: a\nduration: -1\n", "a.yaml")
    child = write(tmp_path, "name: b\nextends: a.yaml\nrate: 99\n", "b.yaml")
    with pytest.raises(ScenarioError) as caught:
        load(child)
    lines = str(caught.value).splitlines()
    assert [line.split(":")[0] for line in lines] == [str(parent), str(child)]


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "empty"),
        ("- a", "not a mapping"),
        ("name: a\nterrain: [", "line 2"),
        ("name: a\nname: b", "given twice"),
        ("name: a\nterrain: {grade: 0, grade: 1}", "'grade' is given twice"),
        ("summary: a", "name is missing"),
        ("name: a\nduration: .nan", "duration = nan"),
        ("name: a\nduration: 2020-01-01", "duration = '2020-01-01'"),
        ("name: a\nextends: rough-crosing", "did you mean 'rough-crossing'"),
        ("name: a\nextends: it.yaml", "leads back"),
        ("name: a\nextends: 3", "no name or path"),
        ("name: a\nexpect: {ground.f2: {min: 1}}", "did you mean 'ground.f1'"),
        ("name: a\nexpect: {ground.f1: {min: 1, max: 0}}", "above max"),
        ("name: a\nactors: [{name: x, kind: car, path: [{t: 1, x: 0, y: 0}, {t: 0, x: 0, y: 0}]}]", "order"),
        ("name: A B", "name = 'A B'"),
        ("name: a\nterrain: 3", "terrain = 3: it must be a mapping"),
    ],
)
def test_bad_files(tmp_path: Path, text: str, match: str) -> None:
    assert match in problem(tmp_path, text)


def test_missing_things_are_named(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="did you mean 'rough-crossing'"):
        load("rugh-crossing")
    with pytest.raises(ScenarioError, match="does not exist"):
        load(tmp_path / "none.yaml")
    with pytest.raises(ScenarioError, match="is a folder"):
        load(tmp_path)
    (tmp_path / "binary.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ScenarioError, match="UTF-8"):
        load(tmp_path / "binary.yaml")
