from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from eval.benchmark.lines import match, tally
from eval.benchmark.profiles import KINDS, make_profile
from eval.cli import BAD_INPUT, DONE, call

TRUE = np.array([[2.0, 10, 0.0, -1.7], [10.5, 30, 0.1, -2.7]])


def found(*lines: tuple[float, float, float, float]) -> np.ndarray:
    return np.array([[*line, 0.01, 20, 1] for line in lines]).reshape(-1, 7)


@pytest.mark.parametrize("kind", KINDS)
def test_the_true_lines_go_through_the_points(kind: str) -> None:
    for seed in range(10):
        made = make_profile(kind, np.random.default_rng(seed), noise=0.0)
        off = np.full(len(made.r), np.nan)
        for start, end, slope, intercept in made.lines:
            on = (made.r >= start) & (made.r <= end)
            assert on.sum() >= 8
            off[on] = made.z[on] - slope * made.r[on] - intercept
        assert 2 <= len(made.lines) <= 8
        lifted = np.abs(off) > 1e-9
        assert lifted.any() == (kind == "obstacles")
        assert lifted.sum() <= 15
        assert (np.abs(np.diff(made.lines[:, 2])) >= 0.06).all()


def test_a_match_is_near_and_one_to_one() -> None:
    r, alpha = match(TRUE, found((2, 10, 0.0, -1.65), (11, 29, 0.1, -2.7)))
    assert r == pytest.approx([0.05, 0])
    assert alpha == pytest.approx([0, 0])
    assert len(match(TRUE, found((2, 5.9, 0, -1.7)))[0]) == 0  # too short
    assert len(match(TRUE, found((2, 10, 0, -1.55)))[0]) == 0  # too high
    assert len(match(TRUE, found((2, 10, 0.06, -2.06)))[0]) == 0  # turned by 3.4 degrees
    assert len(match(TRUE, found((2, 10, 0, -1.7), (2, 9.5, 0, -1.7)))[0]) == 1
    assert len(match(TRUE, found())[0]) == 0


def test_shares_are_of_the_true_and_of_the_found() -> None:
    t = tally([(TRUE, found((2, 10, 0, -1.7), (12, 14, 0.1, -2.7), (15, 17, 0.1, -2.7)))])
    assert (t.true, t.found, t.matched) == (2, 3, 1)
    assert (t.true_positives, t.misses) == (0.5, 0.5)
    assert t.false_positives == pytest.approx(2 / 3)
    assert np.isnan(t.sigma_r)


@pytest.mark.long
def test_the_command_leaves_its_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "lines"
    asked = ["benchmark", "lines", "--seeds", "1", "--profiles", "3", "--rounds", "1", "--out", str(out)]
    assert call(asked) == DONE
    assert "split-and-merge" in capsys.readouterr().out
    written = json.loads((out / "lines.json").read_text())
    assert len(written["extractors"]) == 6
    for one in written["extractors"]:
        parts = [one["tallies"][kind] for kind in KINDS]
        assert sum(t["true"] for t in parts) == one["tallies"]["all"]["true"] > 20
        assert one["tallies"]["all"]["true_positives"] > 0.6
        assert 0 < one["segment_us"] < 1e3 * one["frame_ms"]
    assert (out / "lines.png").read_bytes().startswith(b"\x89PNG")
    assert call(asked) == BAD_INPUT  # results are not overwritten


@pytest.mark.parametrize("wrong", ["--seeds", "--profiles", "--rounds"])
def test_impossible_numbers_are_refused(wrong: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["benchmark", "lines", wrong, "0"]) == BAD_INPUT
    assert "give" in capsys.readouterr().err
