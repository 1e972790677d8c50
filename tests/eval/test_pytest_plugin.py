from __future__ import annotations

import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from eval import run  # now: pytester forgets what a test is the first to import
from scenarios.load import dump
from scenarios.spec import Scenario

pytest_plugins = ("pytester",)


@pytest.fixture
def played(pytester: pytest.Pytester, stage_testbed, monkeypatch) -> pytest.Pytester:
    """Scenario files are played on the stand-in test-bed, in this process."""
    real = run.play
    monkeypatch.setattr(run, "play", lambda scenario, seed: real(scenario, seed, make=stage_testbed))
    return pytester


def put(folder: Path, name: str, **expect: dict[str, float]) -> None:
    world = Scenario.model_validate({"name": name, "duration": 0.3, "expect": expect})
    (folder / f"{name}.scenario.yaml").write_text(dump(world))


def run_pytest(pytester: pytest.Pytester, *arguments: str) -> pytest.RunResult:
    installed = any(e.name == "datmo" for e in entry_points(group="pytest11"))
    plugin = () if installed else ("-p", "eval.pytest_plugin")
    return pytester.runpytest_inprocess(*plugin, *arguments)


def test_files_pass_and_fail_by_what_they_expect(played: pytest.Pytester) -> None:
    put(played.path, "good", **{"ground.f1": {"min": 0.9}})
    put(played.path, "bad", **{"ground.f1": {"min": 0.99}, "recovery.rate": {"min": 0.5}})
    (played.path / "other.yaml").write_text("name: not-a-test")
    result = run_pytest(played, "--datmo-seed", "7", "--datmo-out", "reports")
    result.assert_outcomes(passed=1, failed=1)
    text = result.stdout.str()
    assert "does not meet its expectations" in text
    result.stdout.re_match_lines(
        [
            r".*metric +value +expected",
            r".*ground\.f1 +0\.9712 +≥ 0\.99 +<-- not met",
            r".*recovery\.rate +- +≥ 0\.5 +<-- not met",
            r"figure: .*reports/bad-seed7/figures/birds_eye\.png",
            r"report: .*reports/bad-seed7/report\.html",
            r"replay: datmo run .*bad\.scenario\.yaml --seed 7",
        ]
    )
    assert "Traceback" not in text
    assert (played.path / "reports" / "bad-seed7" / "figures" / "birds_eye.png").exists()
    assert not (played.path / "reports" / "good-seed7").exists()


def test_wrong_files_fail_with_the_reason(played: pytest.Pytester) -> None:
    put(played.path, "nothing")
    (played.path / "typo.scenario.yaml").write_text("name: typo\nduraton: 3\n")
    result = run_pytest(played)
    result.assert_outcomes(failed=2)
    text = result.stdout.str()
    assert "expects nothing" in text
    assert "duration" in text
    assert "Traceback" not in text


def test_a_file_may_be_named_and_selected(played: pytest.Pytester) -> None:
    put(played.path, "one", **{"ground.f1": {"min": 0.9}})
    put(played.path, "two", **{"ground.f1": {"min": 0.9}})
    run_pytest(played, "one.scenario.yaml").assert_outcomes(passed=1)
    run_pytest(played, "-k", "two").assert_outcomes(passed=1, deselected=1)


def test_importing_the_plug_in_is_light() -> None:
    code = (
        "import sys, eval.pytest_plugin; "
        "heavy = {'numba', 'scipy', 'pydantic', 'datmo', 'sim', 'scenarios'} & set(sys.modules); "
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)
