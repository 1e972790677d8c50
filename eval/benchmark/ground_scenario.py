"""The scenarios of the ground benchmark: a town on ground of a stated roughness and slope.

A scenario depends on its class, its grade and one seed alone, so a grid of them can be made in any
part and order. The ground is rolling: half a wave of cosine squared whose flank, where the ego drives,
is as steep as the grade. A plane of any slope would show nothing, as the sensor leans with its vehicle.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from datmo.errors import ConfigError
from scenarios.spec import Scenario
from sim.scene.roughness import CLASSES

FLAT = "flat"
STEEPEST = 30.0
"""The steepest grade that can be asked for [%]."""
ROUGHEST = 1.0
"""The largest rms height that can be asked for [m]."""
WAVE = 80.0
"""Length of the hill or hollow from foot to foot [m]."""
LANE, FIRST_END = 2.0, 11.0
"""x of the ego's first lane, and how far before the crossing that lane ends [m, world]."""
NEAREST, FARTHEST = 15.0, 55.0
"""Where the ego starts, before the end of its first lane [m]."""
ROWS = (
    {"kind": "building", "offset": [7.0, 11.0], "every": 20.0, "jitter": 2.0, "share": 0.35},
    {"kind": "wall", "offset": [2.5, 5.0], "every": 6.0, "share": 0.25},
    {"kind": "hedge", "offset": [2.0, 4.0], "every": 6.0, "share": 0.2},
    {"kind": "pole", "offset": [0.4, 1.0], "every": 20.0, "jitter": 3.0},
    {"kind": "sign", "offset": [0.4, 0.8], "every": 30.0, "jitter": 8.0, "share": 0.6},
    {"kind": "tree", "offset": [2.0, 6.0], "every": 12.0, "jitter": 3.0, "share": 0.5},
    {"kind": "bush", "offset": [1.0, 6.0], "every": 7.0, "jitter": 2.0, "share": 0.5},
)
WALKERS = (
    ("strolling", [6.6, -60.0], [6.6, -15.0], 2),
    ("strolling", [-6.6, -20.0], [-6.6, -65.0], 1),
    ("crossing", [5.4, -28.0], [-5.4, -28.0], 2),
    ("crossing", [5.2, 15.0], [-5.2, 15.0], 1),
    ("strolling", [16.0, -6.6], [45.0, -6.6], 1),
)


def rms_of(roughness: str) -> float | None:
    """The rms height [m] that a name such as "0.3" states; None for a class or "flat".

    Raises:
        ConfigError: the name is neither a class, nor "flat", nor a possible rms.
    """
    if roughness == FLAT or (len(roughness) == 1 and roughness in CLASSES):
        return None
    try:
        rms = float(roughness)
    except ValueError:
        rms = np.nan
    if not 0 < rms <= ROUGHEST:
        raise ConfigError(
            f"class {roughness!r} is no ground; give classes {CLASSES[0]} to {CLASSES[-1]}, {FLAT!r}, or an "
            f"rms height above 0 and up to {ROUGHEST:g} m, such as 0.3"
        )
    return rms


def check_grade(grade: float) -> float:
    """The grade [%], if it is a possible one.

    Raises:
        ConfigError: it is not.
    """
    if not 0 <= grade <= STEEPEST:
        raise ConfigError(f"grade {grade:g} % is not drivable; give 0 to {STEEPEST:g} %")
    return grade


def smoother(roughness: str) -> str:
    """The class of the road beside a field: one smoother, and flat beside class A."""
    return FLAT if roughness in (FLAT, CLASSES[0]) else CLASSES[CLASSES.index(roughness) - 1]


def entropy(roughness: str, grade: float, seed: int) -> list[int]:
    """What a scene draws from: it shares nothing with another class, grade or seed."""
    return [seed, round(grade * 1000), *roughness.encode()]


def scenario_of(roughness: str, grade: float, seed: int, file: str | None = None) -> Scenario:
    """The scenario of one scene.

    Args:
        roughness: class of the field, or "flat". grade: of the steepest flank [%]. seed: of all scenes.
        file: a height map that takes the place of the class.
    """
    rng = np.random.default_rng([*entropy(roughness, grade, seed), 1])
    start = round(rng.uniform(NEAREST, FARTHEST), 2)
    plain = roughness if file is None else FLAT
    terrain: dict[str, Any] = {"roughness": plain, "road_roughness": smoother(plain)}
    terrain["layers"] = _wave(rng, grade, -start - FIRST_END) if grade else []
    terrain["file"] = None if file is None else {"path": file, "pixel": 0.25, "outside": "clamp"}
    people = [dict(zip(("behaviour", "start", "goal", "group"), w, strict=True)) for w in WALKERS]
    return Scenario.model_validate(
        {
            "name": "ground-benchmark",
            "duration": 3.0,
            "terrain": terrain,
            "traffic": {"vehicles": 12, "warm_up": 2.0, "config": {"destination": "o2"}},
            "ego": {"start": start},
            "sensor": {"range": 60.0},
            "pedestrians": people,
            "scenery": {"rows": ROWS, "parking": {"share": 0.25, "vans": 0.2}},
        }
    )


def _wave(rng: np.random.Generator, grade: float, y: float) -> list[dict[str, Any]]:
    """A hill or hollow h cos²(πs/L), whose steepest slope πh/L is at s = L/4: there the ego is."""
    heading = rng.uniform(0, 2 * np.pi)
    kind, name = [("crest", "height"), ("dip", "depth")][int(rng.integers(2))]
    along = WAVE / 4 * np.array([np.cos(heading), np.sin(heading)])
    return [
        {
            "kind": kind,
            "at": [float(LANE + along[0]), float(y + along[1])],
            "heading_deg": float(np.degrees(heading)),
            name: float(grade / 100 * WAVE / np.pi),
            "length": WAVE,
        }
    ]
