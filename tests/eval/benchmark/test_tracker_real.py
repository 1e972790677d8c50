from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from datmo.errors import ConfigError
from datmo.messages import Boxes, Kind
from datmo.tracks import TrackerConfig
from eval.benchmark.kitti_tracks import Drive, read_drive
from eval.benchmark.tracker_ablation import ABLATIONS, WHOLE, ablate
from eval.benchmark.tracker_real import score_real
from eval.benchmark.tracker_rivals import THESIS, Ours, PlainKalman, Rival
from eval.cli import BAD_INPUT, DONE, call

FRAMES = 20


class Reads:
    """Reports what was written down for it."""

    def __init__(self, frames: Sequence[Boxes]) -> None:
        self._frames, self._next = frames, 0

    def reset(self) -> None:
        self._next = 0

    def step(self, boxes: Boxes, stamp: float) -> Boxes:  # noqa: ARG002 - it knows them
        self._next += 1
        return self._frames[self._next - 1]


def row(k: int, ids: Sequence[int], kinds: Sequence[int] = ()) -> Boxes:
    """Cars side by side, 8 m apart, each at 10 m/s."""
    n = len(ids)
    center = np.column_stack([np.full(n, 1.0 * k), 8.0 * np.arange(n), np.zeros(n)])
    kind = np.array(kinds or [Kind.CAR] * n)
    size, score = np.tile([4.0, 1.8, 1.5], (n, 1)), np.full(n, 9.0)
    return Boxes(center, size, np.zeros(n), score=score, id=np.array(ids), kind=kind)


@pytest.fixture
def drive() -> Drive:
    frames = tuple(row(k, (3, 5)) for k in range(FRAMES))
    return Drive("made", np.arange(FRAMES) / 10, frames, frames)


def test_a_perfect_tracker_has_it_all(drive: Drive) -> None:
    found = score_real({"perfect": Reads(drive.truth)}, [drive, drive])["perfect"]
    for got in (found["all"], found["made"]):
        assert (got.hota, got.mota, got.idf1, got.motp) == pytest.approx((1, 1, 1, 1))
        assert (got.switches, got.fragmentations, got.false, got.missed) == (0, 0, 0, 0)


def test_a_new_name_is_one_switch_and_a_gap_one_fragmentation(drive: Drive) -> None:
    renamed = [row(k, (3, 5 if k < 10 else 6)) for k in range(FRAMES)]
    got = score_real({"renamed": Reads(renamed)}, [drive])["renamed"]["all"]
    assert (got.switches, got.fragmentations, got.mota) == (1, 0, pytest.approx(1 - 1 / 40))
    assert got.hota < 1
    torn = [row(k, (3,) if k == 10 else (3, 5)) for k in range(FRAMES)]
    got = score_real({"torn": Reads(torn)}, [drive])["torn"]["all"]
    assert (got.switches, got.fragmentations, got.missed) == (0, 1, 1)


def test_a_distractor_may_be_tracked_or_not(drive: Drive) -> None:
    truth = tuple(row(k, (3, 5, 7), (Kind.CAR, Kind.CAR, Kind.VAN)) for k in range(FRAMES))
    van = Drive("van", drive.stamps, truth, truth)
    for reported in (truth, drive.truth):
        got = score_real({"x": Reads(reported)}, [van])["x"]["all"]
        assert (got.hota, got.false, got.missed) == (pytest.approx(1), 0, 0)


@pytest.mark.parametrize(
    "rival",
    [Ours(), Ours(THESIS), Ours(coasting=True), PlainKalman()],
    ids=["ours", "thesis", "coasting", "kalman"],
)
def test_rivals_keep_one_identity(drive: Drive, rival: Rival) -> None:
    for _ in range(2):  # reset begins anew
        got = score_real({"x": rival}, [drive])["x"]["all"]
        assert (got.switches, got.fragmentations, got.false) == (0, 0, 0)
        assert got.missed <= 2 * 4
        assert got.motp > 0.9
        assert got.milliseconds > 0


def test_what_coasts_is_reported_where_asked(drive: Drive) -> None:
    detections = [row(k, (3,) if k == 12 else (3, 5)) for k in range(FRAMES)]
    torn = Drive("torn", drive.stamps, tuple(detections), drive.truth)
    for make in (Ours, PlainKalman):
        scores = score_real({"hit": make(coasting=False), "coasting": make(coasting=True)}, [torn])
        assert scores["hit"]["all"].fragmentations == 1
        assert scores["coasting"]["all"].fragmentations == 0


def test_ablations_are_known_fields(drive: Drive) -> None:
    for fields in ABLATIONS.values():
        assert set(fields) <= set(TrackerConfig.model_fields)
    made = ablate(TrackerConfig(scores="ignored"), [drive], {"three hits": {"confirm_hits": 3}})
    assert list(made) == [WHOLE, "three hits"]
    assert (made[WHOLE].missed, made["three hits"].missed) == (8, 4)


def test_nothing_to_play() -> None:
    with pytest.raises(ConfigError, match="give at least one"):
        score_real({}, [])


def test_a_real_sequence(real_data: Path) -> None:
    folder = real_data / "real" / "tracks"
    if not folder.is_dir():
        pytest.skip(f"no real tracks at {folder}")
    drive = read_drive(folder, "0003")
    scores = score_real({"ours": Ours(), "kalman": PlainKalman(3.0)}, [drive])
    assert scores["ours"]["all"].hota > 0.5
    assert scores["ours"]["all"].switches == 0
    assert scores["kalman"]["all"].hota > 0.4


def made_folder(base: Path, frames: int) -> Path:
    """One car ahead that drives off at 10 m/s before a camera that stands."""
    lines: dict[str, list[str]] = {"detections": [], "labels": [], "poses": []}
    for k in range(frames):
        box = ["1.5", "1.8", "4", "0", "1.7", str(10.0 + k), "-1.5707963"]
        lines["detections"].append(",".join([str(k), "2", "0", "0", "9", "9", "9.0", *box, "0"]))
        lines["labels"].append(" ".join([str(k), "3", "Car", "0", "0", "0", "0", "0", "9", "9", *box]))
        lines["poses"].append("1 0 0 0 0 1 0 0 0 0 1 0")
    for part, text in lines.items():
        (base / "real" / "tracks" / part).mkdir(parents=True)
        (base / "real" / "tracks" / part / "0042.txt").write_text("\n".join(text) + "\n")
    return base


def test_the_command_leaves_its_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, data = tmp_path / "tracker", made_folder(tmp_path / "data", 12)
    asked = ["benchmark", "tracker", "--sequence", "0042", "--real", str(data), "--out", str(out)]
    assert call(asked) == DONE
    assert "Kalman" in capsys.readouterr().out
    written = json.loads((out / "tracker.json").read_text())
    assert set(written["trackers"]["ours"]) == {"all", "0042"}
    assert written["trackers"]["ours"]["all"]["missed"] == 0  # its score confirms it at once
    assert "| thesis |" in (out / "tracker.md").read_text()
    assert call(["benchmark", "tracker", "--real", str(tmp_path)]) == BAD_INPUT
    assert "give a folder of KITTI" in capsys.readouterr().err
