from __future__ import annotations

import subprocess
import sys
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    hatchling = pytest.importorskip("hatchling.builders.wheel")
    folder = tmp_path_factory.mktemp("wheel")
    return Path(next(hatchling.WheelBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"])))


def test_the_wheel_ships_packages_scenarios_and_types(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    for package in ("datmo", "sim", "scenarios", "eval"):
        assert f"{package}/py.typed" in names
    assert "scenarios/files/rough-crossing.yaml" in names
    assert any(n.startswith("sim/scan/data/") and n.endswith(".csv") for n in names)
    assert not any(n.startswith(("tests/", "docs/")) for n in names)


@pytest.mark.long
def test_gym_makes_both_from_a_plain_install(wheel: Path, tmp_path: Path) -> None:
    venv.create(tmp_path / "env", with_pip=False)
    site = next((tmp_path / "env").glob("lib/python*/site-packages"))
    zipfile.ZipFile(wheel).extractall(site)
    ours = [p for p in sys.path if p.endswith("site-packages")]
    (site / "dependencies.pth").write_text("\n".join(ours))
    code = (
        "import gymnasium as gym, sim, pathlib\n"
        f"assert pathlib.Path(sim.__file__).is_relative_to({str(site)!r}), sim.__file__\n"
        "for id in ('sim:datmo/Lidar-v0', 'eval:datmo/Testbed-v0'):\n"
        "    gym.make(id, scenario='rough-crossing').close()\n"
    )
    python = tmp_path / "env" / "bin" / "python"
    subprocess.run([python, "-c", code], check=True, cwd=tmp_path)


def test_readme_begins_with_the_two_commands() -> None:
    lines, inside = [], False
    for line in (ROOT / "README.md").read_text().splitlines():
        if line.startswith("```"):
            inside = not inside
        elif inside:
            lines.append(line)
    assert lines[0].endswith("datmo run rough-crossing")
    assert "pytest" in lines[1]
    assert all("venv" in line and "pip install" in line for line in lines[:2])


def test_every_extra_and_the_command_are_there() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert set(project["optional-dependencies"]) == {"view", "video", "ray", "formats", "geo", "dev"}
    assert project["scripts"]["datmo"] == "eval.cli:main"
    assert project["entry-points"]["pytest11"]["datmo"] == "eval.pytest_plugin"
