from __future__ import annotations

import base64
import csv
import json
import re

import numpy as np
import pytest

from datmo.errors import ConfigError, OutputError
from eval.report.heights import HeightMap
from eval.report.recording import PICTURES, Recording
from eval.report.timeline import _history, _runs
from eval.run import choose_folder, play, replay_line, write
from eval.score import Metric
from eval.verdict import judge, say_value, within
from scenarios.expect import UNITS
from scenarios.load import load
from scenarios.spec import Bound, Scenario


def scenario(**says: object) -> Scenario:
    return Scenario.model_validate({"name": "staged", "summary": "a <b> & c", "duration": 2.0} | says)


@pytest.fixture
def recording(stage_testbed) -> Recording:
    expect = {"ground.f1": {"min": 0.97}, "ground.leak": {"max": 0.1}, "recovery.rate": {"min": 0.5}}
    return play(scenario(expect=expect), 3, make=stage_testbed)


def test_a_run_leaves_its_files(recording, tmp_path) -> None:
    folder = tmp_path / "run"
    write(recording, folder)
    files = sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file())
    figures = [f"figures/{n}.png" for n in ("birds_eye", "height_error", "stage_times", "timeline")]
    assert files == ["config.yaml", *figures, "metrics.csv", "metrics.json", "report.html"]
    assert load(folder / "config.yaml") == recording.scenario
    content = json.loads((folder / "metrics.json").read_text())
    assert {m["name"]: m["unit"] for m in content["metrics"]} == UNITS
    assert content["seed"] == 3
    assert content["scenario"] == "staged"
    assert content["detail"]["ground"] == {"by_range": {"0-10": 0.99}, "worst": None}
    assert {"python", "numpy", "datmo-gym"} <= set(content["versions"])
    rows = list(csv.DictReader((folder / "metrics.csv").read_text().splitlines()))
    assert [r["value"] for r in rows if r["name"] == "recovery.rate"] == [""]
    assert [float(r["value"]) for r in rows if r["name"] == "ground.f1"] == [0.9712]


def test_the_report_stands_alone(recording, tmp_path) -> None:
    write(recording, tmp_path / "run")
    text = (tmp_path / "run" / "report.html").read_text()
    assert len(text) < 10e6
    assert not re.search(r"""(src|href)=["'](?!data:)""", text)
    assert "http" not in re.sub(r"base64,[A-Za-z0-9+/=]+", "", text)
    assert "a &lt;b&gt; &amp; c" in text
    assert "$" not in re.sub(r"base64,[A-Za-z0-9+/=]+", "", text)
    assert "2 of 3 expectations are not met" in text
    frames = json.loads(re.search(r"const frames = (\[.*?\]), stamps", text).group(1))
    assert len(frames) == len(recording.pictures) == 21
    assert base64.b64decode(frames[0].partition(",")[2])[:2] == b"\xff\xd8"


def test_the_replay_line_says_all_that_matters(recording, tmp_path) -> None:
    assert replay_line(recording, tmp_path / "a b.yaml") == f"datmo run '{tmp_path}/a b.yaml' --seed 3"
    recording.frames, recording.ground = 5, "z-se"
    assert replay_line(recording, tmp_path / "c.yaml").endswith("c.yaml --seed 3 --frames 5 --ground z-se")


def test_frames_are_counted_from_reset(stage_testbed) -> None:
    told = []
    short = play(scenario(), frames=4, on_step=lambda k, n, _: told.append((k, n)), make=stage_testbed)
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert [m.stamp for m in short.moments] == pytest.approx([0, 0.1, 0.2, 0.3])
    assert len(play(scenario(), frames=1, make=stage_testbed).moments) == 1
    assert len(play(scenario(), frames=999, make=stage_testbed).moments) == 21
    for bad in ({"frames": 0}, {"seed": -1}):
        with pytest.raises(ConfigError):
            play(scenario(), make=stage_testbed, **bad)


@pytest.mark.long
def test_a_long_run_keeps_few_pictures(stage) -> None:
    frame, truth = stage(0, n=50)
    recording = Recording(scenario(duration=20.0), 0, 201)
    for _ in range(201):
        recording.add(frame, truth, {})
    assert PICTURES / 2 < len(recording.pictures) <= PICTURES + 1


@pytest.mark.long
def test_out_is_not_overwritten(recording, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    first = choose_folder(None, recording.scenario, 3, False)
    assert str(first) == "runs/staged-seed3"
    write(recording, first)
    assert choose_folder(None, recording.scenario, 3, False).name == "staged-seed3-2"
    with pytest.raises(OutputError, match="--force"):
        choose_folder(first, recording.scenario, 3, False)
    with pytest.raises(OutputError, match="--force"):
        write(recording, first)
    write(recording, choose_folder(first, recording.scenario, 3, True), force=True)


def test_tracks_are_matched_through_hiding_and_change(recording) -> None:
    seen, track, stamp = _history(recording.moments, 4)
    assert stamp[-1] == pytest.approx(2.0)
    assert track.tolist() == [11] * 12 + [31] * 9
    assert list(_runs(seen)) == [(4, 0, 5), (1, 5, 10), (4, 10, 21)]
    assert _history(recording.moments, 300)[1].tolist() == [-1] * 3 + [13] * 18
    assert (_history(recording.moments, 77)[0] == -1).all()


def test_the_height_map_is_the_mean_error_in_world_cells(stage) -> None:
    heights, sums = HeightMap(), {}
    for k in (0, 7):
        frame, truth = stage(k, n=500)
        heights.add(frame, truth)
        T, origin = frame.scan.T_world_sensor, stage(0)[0].scan.T_world_sensor[:2, 3]
        for p, e in zip(frame.scan.points.astype(float), frame.ground.height - truth.height, strict=True):
            if np.hypot(p[0], p[1]) < 50:
                cell = tuple(np.floor(T[:2, :3] @ p + T[:2, 3] - origin).astype(int))
                sums.setdefault(cell, []).append(float(e))
    mean, (west, east, south, north) = heights.mean()
    assert mean.shape == (round(north - south), round(east - west))
    assert np.isfinite(mean).sum() == len(sums)
    for (x, y), errors in sums.items():
        value = mean[round(y + origin[1] - south), round(x + origin[0] - west)]
        assert value == pytest.approx(np.mean(errors))


def test_verdicts() -> None:
    assert within(Bound(min=0.5), 0.5)
    assert within(Bound(max=0.5), 0.5)
    assert not within(Bound(min=0.2, max=0.5), 0.51)
    assert not within(Bound(max=1.0), None)
    assert not within(Bound(max=1.0), float("nan"))
    assert [say_value(v) for v in (None, 0.123456, 12345.6, 3)] == ["-", "0.1235", "1.235e+04", "3"]


def test_judging_keeps_the_order_of_the_scenario(recording) -> None:
    made = judge(recording.scenario.expect, recording.metrics)
    assert [(v.name, v.bound, v.met) for v in made] == [
        ("ground.f1", "≥ 0.97", True),
        ("ground.leak", "≤ 0.1", False),
        ("recovery.rate", "≥ 0.5", False),
    ]


def test_a_run_cut_short_leaves_open_what_may_still_come() -> None:
    expect = {
        "recovery.events": Bound(min=1),
        "recovery.rate": Bound(min=0.5),
        "tracking.id_switches": Bound(max=0),
        "ground.f1": Bound(min=0.9),
    }
    metrics = [
        Metric("recovery.events", 0.0, "count"),
        Metric("recovery.rate", None, "1"),
        Metric("tracking.id_switches", 2.0, "count"),
        Metric("ground.f1", 0.8, "1"),
    ]
    assert [v.word for v in judge(expect, metrics, whole=False)] == ["open", "open", "not met", "not met"]
    assert all(v.failed for v in judge(expect, metrics))
