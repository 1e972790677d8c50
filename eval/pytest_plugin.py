"""pytest plug-in: *.scenario.yaml files are tests; each passes or fails by its `expect:` block.

Imported by every pytest run where the project is installed, so what is heavy waits for the first
scenario file.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from eval.report.recording import Recording
    from eval.verdict import Verdict

SUFFIX = ".scenario.yaml"


def pytest_addoption(parser: pytest.Parser) -> None:
    """--datmo-seed and --datmo-out."""
    group = parser.getgroup("datmo", "scenario files (*.scenario.yaml)")
    group.addoption("--datmo-seed", type=int, default=0, help="seed of the episodes (default 0)")
    group.addoption("--datmo-out", default="runs", help="folder for reports of failures (default runs)")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ScenarioFile | None:
    """A test file for each *.scenario.yaml."""
    if file_path.name.endswith(SUFFIX):
        return ScenarioFile.from_parent(parent, path=file_path)
    return None


class ScenarioFailure(Exception):
    """A scenario did not meet its expectations; the message is all there is to say."""


class ScenarioFile(pytest.File):
    """One file, one test."""

    def collect(self) -> Iterator[ScenarioItem]:
        """The scenario as an item of the name of the file."""
        yield ScenarioItem.from_parent(self, name=self.path.name.removesuffix(SUFFIX))


class ScenarioItem(pytest.Item):
    """Plays the scenario of a file and holds it to its expectations."""

    def runtest(self) -> None:
        """Play; a failure leaves its report."""
        from datmo.errors import DatmoError
        from eval.run import play
        from eval.verdict import judge
        from scenarios.load import load

        try:
            scenario = load(self.path)
            if not scenario.expect:
                raise ScenarioFailure(f"{self.path} expects nothing, so it cannot fail; add an expect: block")
            recording = play(scenario, int(self.config.getoption("--datmo-seed")))
        except DatmoError as error:
            raise ScenarioFailure(str(error)) from None
        verdicts = judge(scenario.expect, recording.metrics)
        if not all(v.met for v in verdicts):
            raise ScenarioFailure(self._explain(recording, verdicts))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The message alone for what a scenario did wrong; a traceback for what we did."""
        if isinstance(excinfo.value, ScenarioFailure):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        """Where the test stands."""
        return self.path, None, f"scenario {self.name}"

    def _explain(self, recording: Recording, verdicts: list[Verdict]) -> str:
        """Table of values and bounds, the figure, and the line that replays it."""
        from eval.output import unused
        from eval.run import replay_line, write
        from eval.verdict import say_value

        root = self.config.rootpath / str(self.config.getoption("--datmo-out"))
        folder = unused(root / f"{recording.scenario.name}-seed{recording.seed}")
        write(recording, folder)
        width = max(len(v.name) for v in verdicts)
        lines = [f"{recording.scenario.name} (seed {recording.seed}) does not meet its expectations:", ""]
        lines.append(f"  {'metric':{width}}  {'value':>10}  expected")
        for v in verdicts:
            unit = "" if v.unit in ("1", "count") else f" {v.unit}"
            mark = "" if v.met else "   <-- not met"
            lines.append(f"  {v.name:{width}}  {say_value(v.value) + unit:>10}  {v.bound}{unit}{mark}")
        lines += ["", f"figure: {folder / 'figures' / 'birds_eye.png'}", f"report: {folder / 'report.html'}"]
        lines.append(f"replay: {replay_line(recording, self.path)}")
        return "\n".join(lines)
