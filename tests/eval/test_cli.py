from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from eval.cli import app, call, main
from scenarios.load import dump
from scenarios.spec import Scenario

COMMANDS = (
    "list",
    "run",
    "test",
    "sweep",
    "generate",
    "digest",
    "compare",
    "segment",
    "detect",
    "view",
    "gallery",
)


@pytest.fixture
def tiny_file(tiny: Scenario, tmp_path: Path) -> Path:
    path = tmp_path / "tiny.yaml"
    path.write_text(dump(tiny))
    return path


def street(path: Path, seed: int = 0) -> Path:
    """A flat street with one car-sized block, as a .bin file."""
    rng = np.random.default_rng(seed)
    angle = np.repeat(np.linspace(-np.pi, np.pi, 900, endpoint=False), 40)
    r = np.tile(np.geomspace(3, 45, 40), 900)
    ground = np.c_[r * np.cos(angle), r * np.sin(angle), rng.normal(-1.73, 0.01, len(r))]
    u = rng.uniform(0, 1, (1500, 2))
    back = np.c_[np.full(700, 10.0), -0.9 + 1.8 * u[:700, 0], -1.5 + 1.4 * u[:700, 1]]
    side = np.c_[10 + 4.2 * u[700:, 0], np.full(800, 0.9), -1.5 + 1.4 * u[700:, 1]]
    points = np.vstack([ground, back, side])
    path.write_bytes(np.c_[points, np.full(len(points), 0.3)].astype("<f4").tobytes())
    return path


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("flag", ["-h", "--help"])
def test_every_command_has_help_with_examples(command: str, flag: str, capsys) -> None:
    assert call([command, flag]) == 0
    said = capsys.readouterr().out
    assert "Examples:" in said
    assert f"datmo {command}" in said


def test_the_root_names_every_command(capsys) -> None:
    assert {c.name for c in app.registered_commands} == set(COMMANDS)
    assert call(["--help"]) == 0
    assert call(["--version"]) == 0
    assert capsys.readouterr().out.splitlines()[-1].startswith("datmo ")


BAD = {
    "unknown scenario": (["run", "rough-crosing"], "rough-crossing"),
    "no scenario": (["run"], "SCENARIO"),
    "unknown command": (["rnu", "x"], "rnu"),
    "unknown option": (["run", "empty-road", "--sed", "3"], "--sed"),
    "no number": (["run", "empty-road", "--seed", "x"], "seed"),
    "negative seed": (["run", "empty-road", "--seed", "-1"], "seed"),
    "no frames": (["run", "empty-road", "--frames", "0"], "frames"),
    "unknown method": (["run", "empty-road", "--ground", "zz"], "zz"),
    "mistyped key": (["run", "empty-road", "--set", "terrain.grad=0.1"], "grade"),
    "no value": (["run", "empty-road", "--set", "terrain.grade"], "KEY=VALUE"),
    "negative duration": (["run", "empty-road", "--set", "duration=-1"], "duration"),
    "unknown tag": (["list", "--tag", "hils"], "hills"),
    "unknown format": (["generate", "empty-road", "--format", "ketti", "--out", "o"], "semantickitti"),
    "empty over": (["sweep", "empty-road", "--over", "terrain.grade="], "terrain.grade"),
    "no seeds": (["sweep", "empty-road", "--over", "terrain.grade=0", "--seeds", "a"], "seeds"),
    "bad value in a sweep": (["sweep", "empty-road", "--over", "terrain.roughness=A,Z"], "Z"),
    "no film": (["view", "empty-road", "--out", "film.avi"], ".gif"),
    "no file": (["segment", "none.bin", "--out", "a.label"], "no such file"),
    "a folder": (["detect", ".", "--out", "a.json"], "folder"),
    "an empty folder": (["test", "."], "scenario.yaml"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_line_and_status_2(case: str, capsys, tmp_path, monkeypatch) -> None:
    arguments, hint = BAD[case]
    monkeypatch.chdir(tmp_path)
    assert call(arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
    assert said.err.startswith("datmo: ")
    assert hint in said.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"x" * 33, np.full(4, np.nan, "<f4").tobytes()])
def test_bad_clouds_write_nothing(content: bytes, capsys, tmp_path) -> None:
    cloud, out = tmp_path / "bad.bin", tmp_path / "out"
    cloud.write_bytes(content)
    assert call(["segment", str(cloud), "--out", str(out)]) == 2
    assert call(["detect", str(cloud), "--out", str(out)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 2
    assert not out.exists()


def test_debug_shows_the_traceback() -> None:
    from datmo.errors import ScenarioError

    with pytest.raises(ScenarioError):
        call(["--debug", "run", "nothing-of-the-kind"])
    with pytest.raises(ScenarioError):
        call(["run", "nothing-of-the-kind", "--debug"])


def test_stopping_is_quiet(capsys, monkeypatch) -> None:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("scenarios.load.load", stop)
    assert call(["run", "empty-road"]) == 130
    assert capsys.readouterr().err == "datmo: stopped\n"


def test_segment_labels_every_point_of_the_file(capsys, tmp_path) -> None:
    cloud, out = street(tmp_path / "a.bin"), tmp_path / "a.label"
    rows = np.fromfile(cloud, "<f4").reshape(-1, 4)
    rows[5, 2] = np.nan
    cloud.write_bytes(rows.tobytes())
    arguments = ["segment", str(cloud), "--out", str(out), "--picture", str(tmp_path / "a.png")]
    assert call(arguments) == 0
    label = np.fromfile(out, "<u4")
    assert len(label) == len(rows)
    assert label[5] == 0
    assert np.mean(label[6:36000] == 40) > 0.98
    assert np.mean(label[36000:][rows[36000:, 2] > -1.3] == 99) > 0.98
    assert (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"
    assert "1 points with NaN" in capsys.readouterr().out
    before = out.read_bytes()
    assert call(arguments) == 2
    assert "--force" in capsys.readouterr().err
    assert call([*arguments, "--force"]) == 0
    assert out.read_bytes() == before


def test_detect_finds_the_block(tmp_path) -> None:
    cloud, out = street(tmp_path / "a.bin"), tmp_path / "boxes.json"
    assert call(["detect", str(cloud), "--out", str(out), "--picture", str(tmp_path / "a.png")]) == 0
    boxes = json.loads(out.read_text())["boxes"]
    best = min(boxes, key=lambda b: abs(b["center"][0] - 12.1) + abs(b["center"][1]))
    np.testing.assert_allclose(best["center"][:2], [12.1, 0], atol=0.3)
    np.testing.assert_allclose(best["size"][:2], [4.2, 1.8], atol=0.3)
    assert best["points"] > 1000
    assert (tmp_path / "a.png").exists()


def test_run_replays_to_the_same_metrics(tiny_file, tmp_path, capsys) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    assert call(["run", str(tiny_file), "--seed", "4", "--frames", "3", "--out", str(first)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == f"report: {first / 'report.html'}"
    assert (
        call(["run", str(first / "config.yaml"), "--seed", "4", "--frames", "3", "--out", str(second)]) == 0
    )
    made = [json.loads((f / "metrics.json").read_text())["metrics"] for f in (first, second)]
    timeless = [[m for m in metrics if not m["name"].startswith("speed.")] for metrics in made]
    assert timeless[0] == timeless[1]
    assert call(["run", str(tiny_file), "--out", str(first)]) == 2


def test_an_expectation_not_met_is_status_1(tiny_file, tmp_path, capsys) -> None:
    arguments = ["run", str(tiny_file), "--frames", "2", "--set", "expect.ground.leak.min=1.0"]
    assert call([*arguments, "--out", str(tmp_path / "a")]) == 1
    assert "not met: ground.leak" in capsys.readouterr().out
    met = ["run", str(tiny_file), "--frames", "2", "--set", "expect.ground.f1.min=0.1"]
    assert call([*met, "--out", str(tmp_path / "b")]) == 0


@pytest.mark.long
def test_test_reports_each_scenario(tiny, tmp_path, capsys) -> None:
    folder = tmp_path / "scenarios"
    folder.mkdir()
    for name, bound in (("good", {"min": 0.1}), ("bad", {"max": 0.1})):
        world = tiny.model_copy(update={"name": name})
        text = dump(Scenario.model_validate(world.model_dump() | {"expect": {"ground.f1": bound}}))
        (folder / f"{name}.scenario.yaml").write_text(text)
    out = tmp_path / "out"
    assert call(["test", str(folder), "--frames", "2", "--out", str(out)]) == 1
    said = capsys.readouterr().out
    assert "1 passed, 1 failed" in said
    assert "replay: datmo run" in said
    assert [p.name for p in out.iterdir()] == ["bad-seed0"]
    assert call(["test", str(folder / "good.scenario.yaml"), "--frames", "2"]) == 0


@pytest.mark.long
def test_view_writes_a_film(tiny_file, tmp_path) -> None:
    from PIL import Image

    film = tmp_path / "film.gif"
    base = ["view", str(tiny_file), "--frames", "3", "--pixels", "200"]
    assert call([*base, "--out", str(film)]) == 0
    with Image.open(film) as made:
        assert made.n_frames == 3
        assert made.size == (200, 200)
    assert call([*base, "--out", str(tmp_path / "last.png")]) == 0


def test_list_names_the_scenarios(capsys) -> None:
    from scenarios.catalog import names, tagged

    assert call(["list"]) == 0
    said = capsys.readouterr().out
    assert all(name in said for name in names())
    assert call(["list", "--tag", "smoke"]) == 0
    said = capsys.readouterr().out
    assert [name for name in names() if name in said] == list(tagged("smoke"))


def test_the_entry_point_leaves_with_the_status(monkeypatch, capsys) -> None:
    monkeypatch.setattr(sys, "argv", ["datmo", "run"])
    with pytest.raises(SystemExit) as left:
        main()
    assert left.value.code == 2
    assert capsys.readouterr().err.startswith("datmo: ")


def test_help_is_quick_and_light() -> None:
    code = (
        "import sys; from eval.cli import call; call(['--help']); "
        "heavy = {'numba', 'scipy', 'highway_env', 'embreex', 'matplotlib', 'pydantic'} & set(sys.modules); "
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True, capture_output=True)
