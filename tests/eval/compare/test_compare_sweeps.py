"""Statistics of sweeps whose figures are known."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from datmo.errors import CloudFileError, ConfigError
from datmo.messages import Kind
from eval.cli import call
from eval.compare import Profile, judge, mean, profile, show
from eval.compare.elevation import errors
from eval.compare.sweeps import real
from scenarios.load import dump
from scenarios.spec import Scenario
from sim.scan.pattern import pattern
from sim.scan.units import unit

UNIT = unit("hdl64e-s3-20171102")


def road(noise: float = 0.008, lost: float = 0.01, seed: int = 0) -> tuple[np.ndarray, ...]:
    """Points, intensity, ring and kind of a level road in a bowl of 70 m, ring by ring."""
    rng = np.random.default_rng(seed)
    rays = pattern(UNIT, 10)
    with np.errstate(divide="ignore"):
        t = (-1.73 - rays.origins[..., 2]) / rays.directions[..., 2]
    t = np.where((t > 0) & (t < 70), t, 70.0)
    there = rng.random(t.shape) >= lost
    ring = np.broadcast_to(np.arange(64)[:, None], t.shape)[there].astype(np.uint8)
    t = t[there] + noise * rng.standard_normal(there.sum())
    points = (rays.origins[there] + t[:, None] * rays.directions[there]).astype(np.float32)
    intensity = np.where(rng.random(len(t)) < 0.1, 0, 0.25).astype(np.float32)
    return points, intensity, ring, np.full(len(t), Kind.ROAD, np.uint8)


def test_a_sweep_tells_the_figures_it_was_made_with() -> None:
    got = profile(*road())
    assert got.columns == pytest.approx(2083, rel=2e-3)
    assert got.residual == pytest.approx(0.008, rel=0.05)
    assert got.drop_outs == pytest.approx(0.01, abs=0.0015)
    assert got.missing == pytest.approx(0.01, abs=0.01)
    assert got.zeros == pytest.approx(0.1, abs=0.005)
    assert got.by_kind[Kind.ROAD] == pytest.approx(0.225, abs=0.003)
    assert got.ranges.sum() == pytest.approx(1)
    distance = np.linalg.norm(road()[0], axis=1)
    assert got.ranges[1] == pytest.approx(((distance >= 5) & (distance < 10)).mean())


@pytest.mark.parametrize(("noise", "lost"), [(0.004, 0.0), (0.012, 0.04)])
def test_noise_and_drop_outs_are_told_apart(noise: float, lost: float) -> None:
    got = profile(*road(noise, lost))
    assert got.residual == pytest.approx(noise, rel=0.05)
    assert got.drop_outs == pytest.approx(lost * (1 - lost), abs=0.003)


def test_rings_are_held_against_the_table() -> None:
    points, _, ring, _ = road(0.0)
    off = errors(points, ring, UNIT)
    assert np.nanmax(np.abs(off)) < 1e-3
    bent = points.copy()
    bent[ring == 40, 2] += 0.002 * np.hypot(*points[ring == 40, :2].T)
    off = errors(bent, ring, UNIT)
    assert off[40] == pytest.approx(np.degrees(0.002) * np.cos(UNIT.elevation[40]) ** 2, rel=0.05)
    assert np.nanmax(np.abs(np.delete(off, 40))) < 1e-3


def test_the_mean_leaves_out_what_a_sweep_lacks() -> None:
    one, other = profile(*road()), profile(*road(seed=1)[:3])
    both = mean([one, other, other])
    assert both.by_kind == one.by_kind
    assert both.points == pytest.approx((one.points + 2 * other.points) / 3)
    assert np.isnan(both.elevation).sum() == np.isnan(one.elevation).sum()
    with pytest.raises(ConfigError, match=r"\[32, 64\] rings"):
        mean([one, replace(one, missing=one.missing[:32])])


def verdicts(real: Profile, simulated: Profile, off: np.ndarray) -> dict[str, bool | None]:
    return {line.name: line.met for line in judge(real, simulated, UNIT, off)}


def test_what_is_alike_passes_and_what_is_not_is_named() -> None:
    one = replace(profile(*road()), by_kind={Kind.ROAD: 0.2})
    none = np.zeros(64)
    alike = verdicts(one, one, none)
    assert {name for name, met in alike.items() if met is False} == {
        f"intensity, {k}" for k in ("sidewalk", "field", "vegetation", "building", "car", "sign")
    }
    assert sum(met is True for met in alike.values()) >= 12
    for change, name in (
        ({"points": 0.94 * one.points}, "returns a sweep"),
        ({"missing": one.missing + 0.04}, "missing, rings 40-47"),
        ({"residual": 0.012}, "noise of range on the road"),
        ({"drop_outs": 0.016}, "isolated drop-outs"),
        ({"ranges": np.roll(one.ranges, 1)}, "range histogram, L1"),
        ({"by_kind": {Kind.ROAD: 0.26}}, "intensity, road"),
    ):
        assert alike[name]
        assert verdicts(one, replace(one, **change), none)[name] is False
    tilted = none.copy()
    tilted[7] = -0.11
    assert verdicts(one, one, tilted)["elevation off the unit's table, worst ring"] is False


def test_a_lidar_of_other_rings_is_refused() -> None:
    one = profile(*road())
    with pytest.raises(ConfigError, match=r"64 rings.*sensor\.unit"):
        judge(one, replace(one, missing=one.missing[:16]), unit("vlp-16"), np.zeros(16))


def test_a_cloud_that_is_no_sweep_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="12 points"):
        profile(*(a[:12] for a in road()))
    mixed = np.random.default_rng(0).normal(size=(5000, 4)).astype("<f4")
    path = tmp_path / "mixed.bin"
    path.write_bytes(mixed.tobytes())
    with pytest.raises(CloudFileError, match="ring by ring"):
        real(path)


def test_labels_beside_a_cloud_are_its_classes(tmp_path: Path) -> None:
    points, intensity, ring, _ = road()
    turn = np.arctan2(points[:, 1], points[:, 0]) % (2 * np.pi)
    order = np.lexsort((turn, ring))
    path = tmp_path / "sweep.bin"
    path.write_bytes(np.column_stack([points, intensity])[order].astype("<f4").tobytes())
    plain = real(path)
    assert not plain.by_kind
    (tmp_path / "sweep.label").write_bytes(np.full(len(points), 48 | 7 << 16, "<u4").tobytes())
    assert set(real(path).by_kind) == {Kind.SIDEWALK}
    (tmp_path / "sweep.label").write_bytes(np.full(7, 48, "<u4").tobytes())
    with pytest.raises(CloudFileError, match="7 labels"):
        real(path)


def test_real_sweeps_are_as_measured_elsewhere(real_data: Path) -> None:
    """The figures that the data's own description gives."""
    sweeps = [real(path) for path in sorted((real_data / "real" / "frames").glob("*.bin"))]
    got = mean(sweeps)
    assert 115_000 < got.points < 127_000
    assert 0.007 < got.residual < 0.011
    assert 0.005 < got.drop_outs < 0.015
    np.testing.assert_allclose(got.ranges, [0.06, 0.43, 0.33, 0.11, 0.03, 0.03, 0.01], atol=0.012)
    assert 0.08 <= got.zeros <= 0.1
    assert got.intensity == pytest.approx(0.29, abs=0.01)


@pytest.mark.long
def test_the_command_leaves_its_table_and_figure(tmp_path: Path, tiny: Scenario, capsys) -> None:
    points, intensity, ring, _ = road()
    turn = np.arctan2(points[:, 1], points[:, 0]) % (2 * np.pi)
    rows = np.column_stack([points, intensity])[np.lexsort((turn, ring))]
    (tmp_path / "sweep.bin").write_bytes(rows.astype("<f4").tobytes())
    (tmp_path / "tiny.yaml").write_text(dump(tiny.model_copy(update={"name": "tiny"})))
    asked = ["compare", str(tmp_path / "sweep.bin"), "--scenario", str(tmp_path / "tiny.yaml")]
    assert call([*asked, "--sweeps", "1", "--out", str(tmp_path / "out")]) == 1
    said = capsys.readouterr().out
    assert "range histogram, L1" in said
    record = json.loads((tmp_path / "out" / "compare.json").read_text())
    assert record["real"] == ["sweep.bin"]
    assert {line["met"] for line in record["lines"]} == {True, False, None}
    assert (tmp_path / "out" / "compare.png").read_bytes().startswith(b"\x89PNG")


def test_a_value_that_is_not_there_is_a_dash() -> None:
    assert show.say(float("nan"), "m") == "-"
    assert show.say(124584.0, "") == "124,584"
    assert show.say(0.0081, "m") == "0.0081 m"
