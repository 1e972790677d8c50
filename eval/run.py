"""Playing a scenario through the whole loop, and writing what came of it."""

from __future__ import annotations

import csv
import io
import json
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from datmo.messages import Frame
from eval import facts
from eval.episode import episode, scans_to_play
from eval.output import refuse_existing, unused, writing_folder
from eval.report.recording import Recording, encode
from eval.score import Metric
from eval.testbed import Testbed, make_testbed
from scenarios.load import dump
from scenarios.spec import Scenario

OnStep = Callable[[int, int, dict[str, Any]], None]
"""Called after each frame with its number, the total, and the step's `info`."""


def play(
    scenario: Scenario,
    seed: int = 0,
    frames: int | None = None,
    ground: str | None = None,
    on_step: OnStep | None = None,
    make: Callable[..., Testbed] = make_testbed,
) -> Recording:
    """Play one episode and keep what a report needs of it.

    Args:
        scenario: what happens; an ego under `control: agent` gets its idle action.
        seed: of the episode.
        frames: scans to play, reset's included; None plays to the end of the scenario.
        ground: the ground method; None keeps the default.
        on_step: told of each frame.
        make: makes the test-bed.

    Raises:
        ConfigError: `frames` is below 1.
    """
    total = scans_to_play(scenario, frames)
    env = make(scenario, ground=ground)
    recording = Recording(scenario, seed, total, ground)
    try:
        for k, info in enumerate(episode(env, scenario, seed, total)):
            recording.add(info["frame"], info["truth"], stage_times(env, info))
            if on_step is not None:
                on_step(k + 1, total, info)
        recording.metrics, recording.detail = list(env.result()), env.detail()
    finally:
        env.close()
    return recording


def write(recording: Recording, folder: Path, force: bool = False) -> None:
    """Write config.yaml, metrics.json, metrics.csv, report.html and figures/ into `folder`.

    Raises:
        OutputError: `folder` exists and `force` is not set.
    """
    from eval.report.figures import height_error, stage_times
    from eval.report.page import page
    from eval.report.timeline import timeline

    known = {"versions": facts.versions(), "hardware": facts.hardware()}
    with writing_folder(folder, force) as beside:
        figures = {
            "timeline": timeline(recording.moments, recording.scenario.rate),
            "height_error": height_error(recording.heights),
            "stage_times": stage_times(recording.moments),
        }
        if recording.last is not None:
            figures["birds_eye"] = encode(recording.last, "PNG")
        (beside / "figures").mkdir()
        for name, data in figures.items():
            (beside / "figures" / f"{name}.png").write_bytes(data)
        (beside / "config.yaml").write_text(dump(recording.scenario), encoding="utf-8")
        (beside / "metrics.json").write_text(metrics_json(recording, known), encoding="utf-8")
        (beside / "metrics.csv").write_text(metrics_csv(recording.metrics), encoding="utf-8")
        report = page(recording, figures, replay_line(recording, folder / "config.yaml"), known)
        (beside / "report.html").write_text(report, encoding="utf-8")


def choose_folder(out: Path | None, scenario: Scenario, seed: int, force: bool) -> Path:
    """Where a run goes: `out`, or an unused folder under runs/. Says so before playing, not after.

    Raises:
        OutputError: `out` exists and `force` is not set.
    """
    if out is None:
        return unused(Path("runs") / f"{scenario.name}-seed{seed}")
    refuse_existing(out, force)
    return out


def replay_line(recording: Recording, config: Path) -> str:
    """The command that plays the same run again."""
    words = ["datmo", "run", str(config), "--seed", str(recording.seed)]
    if recording.frames < recording.scenario.scans:
        words += ["--frames", str(recording.frames)]
    if recording.ground:
        words += ["--ground", recording.ground]
    return shlex.join(words)


def metrics_json(recording: Recording, known: dict[str, Any]) -> str:
    """The text of metrics.json."""
    content = {
        "metrics": [{"name": m.name, "value": m.value, "unit": m.unit} for m in recording.metrics],
        "seed": recording.seed,
        "scenario": recording.scenario.name,
        "frames": len(recording.moments),
        "ground": recording.ground,
        **known,
        "detail": recording.detail,
    }
    return json.dumps(_plain(content), indent=2, allow_nan=False) + "\n"


def metrics_csv(metrics: list[Metric]) -> str:
    """The text of metrics.csv; an empty value is a metric with nothing to measure."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["name", "value", "unit"])
    rows.writerows([m.name, "" if m.value is None else repr(float(m.value)), m.unit] for m in metrics)
    return text.getvalue()


def stage_times(env: Testbed, info: dict[str, Any]) -> dict[str, float]:
    """Milliseconds of traffic, cast and each stage of perception, in the order in which they run."""
    frame: Frame = info["frame"]
    world = env.lidar.milliseconds
    return {name: world[name] for name in ("traffic", "cast") if name in world} | frame.milliseconds


def _plain(value: Any) -> Any:
    """The same in JSON's own types; NaN and infinity become null."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value
