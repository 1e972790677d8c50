from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from datmo.errors import ConfigError
from datmo.messages import Relief, Scan, Truth
from eval.benchmark import ground_scenes, store
from eval.benchmark.ground_scenario import WAVE, rms_of, scenario_of, smoother
from eval.benchmark.ground_scenes import Scene, scenes
from eval.metrics.ground import grid_centres
from scenarios.spec import Scenario


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, tiny: Scenario) -> None:
    """Scenes that are quick to make, kept in a folder of the test's own."""

    def scenario(roughness: str, grade: float, seed: int, file: str | None = None) -> Scenario:
        return tiny.model_copy(update={"name": f"tiny-{seed}"})

    monkeypatch.setenv(store.cache.VARIABLE, str(tmp_path))
    monkeypatch.setattr(ground_scenes, "scenario_of", scenario)
    monkeypatch.setattr(ground_scenes, "APART", 2)


def _same(a: Scene, b: Scene) -> bool:
    return all(getattr(a, f.name) == getattr(b, f.name) for f in fields(Scene))


def test_a_scene_is_the_same_whatever_else_is_asked_for_and_wherever_it_comes_from(
    small: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[Any] = []
    first, second = scenes(["C"], [0, 5], seed=3, on_scene=lambda *said: told.append(said))
    assert told == [(0, "C-0"), (1, "C-5")]
    assert (first.name, first.roughness, first.grade) == ("C-0", "C", 0.0)
    assert [type(m) for m in (first.scan, first.truth, first.relief)] == [Scan, Truth, Relief]
    assert len(first.scan) == len(first.truth.is_ground) > 10_000
    np.testing.assert_array_equal(first.relief.xy, grid_centres())
    assert not np.array_equal(first.scan.points, second.scan.points)
    with monkeypatch.context() as patch:
        patch.setattr(ground_scenes, "_make", lambda *_: pytest.fail("a kept scene was made again"))
        (kept,) = scenes(["C"], [5], seed=3)
    monkeypatch.setenv(store.cache.VARIABLE, "off")
    (anew,) = scenes(["C"], [5], seed=3)
    assert _same(second, kept)
    assert _same(second, anew)


@pytest.mark.long
def test_scans_of_a_scene_are_apart_and_a_broken_file_is_made_anew(small: None) -> None:
    one, two = scenes(["0.1"], [0], scans=2)
    assert (one.name, two.name) == ("0.1-0", "0.1-0#1")
    assert two.scan.stamp - one.scan.stamp == pytest.approx(0.2)
    (path,) = (store.folder() or Path()).glob("*.npz")
    path.write_bytes(path.read_bytes()[:1000])
    again = list(scenes(["0.1"], [0], scans=2))
    assert _same(again[1], two)


def test_the_oldest_scenes_go_first(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv(store.cache.VARIABLE, str(tmp_path))
    monkeypatch.setattr(store, "MOST_BYTES", 20_000)
    for name in "abc":
        store.kept(name, lambda: {"x": np.zeros(1000)})
    left = {p.stem for p in (tmp_path / "scenes").iterdir()}
    assert left == {"b", "c"}


def test_the_ground_is_as_steep_as_its_grade_where_the_ego_starts() -> None:
    scenario = scenario_of("E", 10.0, 4)
    (layer,) = scenario.terrain.layers
    height = getattr(layer, "height", None) or getattr(layer, "depth", None)
    assert height * np.pi / WAVE == pytest.approx(0.1)
    away = np.array(layer.at) - [2.0, -(scenario.ego.start or 0) - 11.0]
    assert np.hypot(*away) == pytest.approx(WAVE / 4)
    assert (scenario.terrain.roughness, scenario.terrain.road_roughness) == ("E", "D")
    assert smoother("A") == smoother("flat") == "flat"
    assert scenario_of("E", 0.0, 4).terrain.layers == ()
    assert scenario == scenario_of("E", 10.0, 4) != scenario_of("E", 10.0, 5)


def test_a_stated_rms_is_met() -> None:
    field = ground_scenes._field(0.3, [1, 2])
    assert field.std() == pytest.approx(0.3, rel=1e-9)
    assert rms_of("0.3") == 0.3
    assert rms_of("E") is rms_of("flat") is None


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"classes": ["J"]}, "class 'J'.*give classes A to H"),
        ({"classes": ["nan"]}, "class 'nan'"),
        ({"classes": []}, "classes is empty.*give"),
        ({"grades": []}, "grades is empty.*give"),
        ({"grades": [31.0]}, "grade 31 %.*give 0 to 30"),
        ({"seed": -1}, "seed -1.*give"),
        ({"scans": 0}, "scans 0.*give"),
    ],
)
def test_what_cannot_be_made_is_refused_at_once(wrong: dict[str, Any], says: str) -> None:
    with pytest.raises(ConfigError, match=says):
        scenes(**wrong)
