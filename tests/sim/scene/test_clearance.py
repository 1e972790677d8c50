from __future__ import annotations

import numpy as np
import pytest

from datmo.errors import ScenarioError
from scenarios.load import load
from scenarios.spec import Actor, Scenario
from sim.scene import clearance
from sim.scene.clearance import shared
from sim.scene.pedestrians import Crowd
from sim.scene.script import Script, looks_of
from sim.scene.vehicles import State, body
from sim.scene.world import World


def actor(name: str, kind: str, *path: tuple[float, float, float], yaw: float = 0.0) -> dict[str, object]:
    points = tuple({"t": t, "x": x, "y": y} for t, x, y in path)
    return {"name": name, "kind": kind, "path": points, "yaw_deg": yaw}


def check(**parts: object) -> None:
    scenario = Scenario.model_validate({"name": "it", **parts})
    scripted = [Script(a).state(1 + i, looks_of(a), 0.0) for i, a in enumerate(scenario.actors)]
    seeds = [np.random.SeedSequence(i) for i in range(len(scenario.pedestrians))]
    clearance.check(scenario, scripted, Crowd(scenario.pedestrians, [], seeds, 0.0).parties)


def box(x: float, y: float, length: float, width: float) -> np.ndarray:
    half = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [length / 2, width / 2]
    return half + np.array([x, y])


def test_the_depth_is_the_least_way_out() -> None:
    assert shared(box(0, 0, 4, 2), box(3.5, 0, 4, 2)) == pytest.approx(0.5)
    assert shared(box(0, 0, 4, 2), box(0.2, 1.7, 4, 2)) == pytest.approx(0.3)
    assert shared(box(0, 0, 4, 2), box(0, 2.1, 4, 2)) < 0
    assert shared(box(0, 0, 4, 2), box(50, 0, 4, 2)) == 0


def walk(y: float) -> dict[str, object]:
    return {"start": (0.0, y), "goal": (9.0, 9.0)}


CAR = actor("a", "car", (0, 0, 0))


@pytest.mark.parametrize(
    ("parts", "names"),
    [
        ({"actors": (CAR, actor("b", "truck", (-4, -40, 0.5), (4, 40, 0.5)))}, ("actor 'a'", "actor 'b'")),
        (
            {"actors": (CAR,), "pedestrians": ({"start": (0.5, 0.5), "goal": (9.0, 9.0)},)},
            ("'a'", "pedestrian 0"),
        ),
        ({"actors": (CAR,), "things": ({"kind": "pole", "at": (1.0, 0.0)},)}, ("'a'", "thing 0 \\(pole\\)")),
        (
            {"pedestrians": [{"start": (0, y), "goal": (9, 9)} for y in (0, 0.2)]},
            ("pedestrian 0", "pedestrian 1"),
        ),
    ],
)
def test_who_begins_inside_another_is_refused_with_both_names(parts: dict, names: tuple[str, str]) -> None:
    with pytest.raises(
        ScenarioError, match=rf"{names[0]}.* begins inside .*{names[1]}.* overlap .*move one of"
    ):
        check(**parts)


def test_who_begins_clear_is_not() -> None:
    beside = actor("b", "car", (0, 0, 2.2))
    gone = actor("c", "car", (-9, 0.0, 0.0), (-5, 0, 20), (5, 0, 60))
    check(actors=(CAR, beside, gone), pedestrians=({"start": (0, -3), "goal": (9, -3), "group": 3},))


def test_the_ego_is_told_too() -> None:
    scenario = Scenario.model_validate({"name": "it", "actors": (CAR,)})
    ego = State(0, body("car/1"), np.array([3.0, 0.0]), 0.0, np.zeros(2))
    with pytest.raises(ScenarioError, match="the ego begins inside actor 'a'"):
        clearance.check_ego(scenario, ego, [Script(Actor.model_validate(CAR)).state(1, body("car/0"), 0.0)])
    settings = {"terrain.cell": "2.0", "pedestrians.1.start": "[5.2, 15.0]"}
    with pytest.raises(ScenarioError, match="pedestrian 0 begins inside pedestrian 1"):
        World(load("rough-crossing", settings), np.random.SeedSequence(0))
