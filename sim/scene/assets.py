"""The catalogue of meshes: what actors look like to the sensor.

A key reads name/variant[/gait][/phase][~seed]:
    "car/2"                  the third car of its makers' measures; van, truck and bus alike
    "car/2~17"               another car of that class; seeds 0 (the nominal one) .. 31
    "pedestrian/0"           a person who stands
    "pedestrian/0/5"         who walks, at phase 5 of GAIT_PHASES in a cycle of two steps
    "pedestrian/0/run/5"     who runs
    "bicycle/0/5~3"          a bicycle with its rider, at a phase of the cranks; "bicycle/0" coasts
    "motorcycle/0"           with its rider
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from datmo.arrays import F32, F64, I32
from datmo.errors import SimulationError, nearest
from datmo.messages import Kind
from sim.scene.bodies.families import FAMILIES, WALK, named
from sim.scene.bodies.gait import GAIT_PHASES
from sim.scene.bodies.primitives import Shell
from sim.scene.bodies.variety import SEEDS, Look, Variety, parse

__all__ = ["GAIT_PHASES", "SEEDS", "Asset"]


def keys(kind: Kind) -> tuple[str, ...]:
    """Keys of the variants of a kind, standing; `at_phase` makes them move, "~<seed>" varies them.

    Raises:
        SimulationError: the catalogue has no mesh of this kind.
    """
    for family in FAMILIES.values():
        if family.kind == kind:
            return tuple(f"{family.name}/{i}" for i in range(len(family.words)))
    known = ", ".join(family.kind.name for family in FAMILIES.values())
    raise SimulationError(f"there is no mesh of kind {Kind(kind).name}; choose one of {known}")


def catalogue() -> tuple[str, ...]:
    """Every nominal key, one for each variant of each kind, in its form at rest."""
    return tuple(key for family in FAMILIES.values() for key in keys(family.kind))


def describe(key: str) -> str:
    """What a mesh is, in a few words: "hatchback, 4.3 x 1.8 x 1.5 m"."""
    look = _look(key)
    length, width, height = asset(key).size
    return f"{FAMILIES[look.name].words[look.variant]}, {length:.1f} x {width:.1f} x {height:.1f} m"


def car(variant: int) -> Asset:
    """Hatchback, saloon, sport utility, small car, estate or pick-up: 0 .. 5."""
    return asset(f"car/{variant}")


def van(variant: int) -> Asset:
    """Transporter or high van: 0, 1."""
    return asset(f"van/{variant}")


def truck(variant: int) -> Asset:
    """Box truck with two or three axles, lorry with semi-trailer: 0 .. 2."""
    return asset(f"truck/{variant}")


def pedestrian(phase: int | None, variant: int) -> Asset:
    """A person 0 .. 7 at a phase 0 .. GAIT_PHASES - 1 of walking, or standing; walks along +x."""
    return asset(f"pedestrian/{variant}" if phase is None else f"pedestrian/{variant}/{phase}")


def stride(variant: int, gait: str = WALK, seed: int = 0) -> float:
    """Metres that a pedestrian goes in one cycle of a gait ("walk", "run"), that is in GAIT_PHASES phases."""
    return cycle(at_phase(Look("pedestrian", variant, seed=seed).key, 0, gait))


def at_phase(key: str, phase: int, gait: str = "") -> str:
    """The same body (its seed kept) at a phase of a gait; of its usual one, if none is named.

    Raises:
        SimulationError: it has no such gait, or none at all.
    """
    look = _look(key)
    gaits = FAMILIES[look.name].gaits
    if not gaits or (gait and gait not in gaits):
        raise SimulationError(f"{key!r} has no gait {gait!r}; {nearest(gait, gaits)}")
    return replace(look, gait=named(gaits, gait or gaits[0]), phase=phase % GAIT_PHASES).key


def at_rest(key: str) -> str:
    """The same body, standing."""
    return _look(key).still.key


def cycle(key: str) -> float:
    """Metres gone in one cycle of a key's gait, GAIT_PHASES phases; 0 for what has no gait."""
    look = _look(key)
    return FAMILIES[look.name].cycle(look, Variety(look))


def asset(key: str) -> Asset:
    """The mesh of a key, made once in a process.

    Raises:
        SimulationError: there is no such key; the nearest are named.
    """
    look = _look(key)
    return _forms(look.still)[look]


@cache
def _look(key: str) -> Look:
    look = parse(key)
    if look.name not in FAMILIES or not FAMILIES[look.name].has(look):
        raise SimulationError(f"there is no asset {key!r}; {nearest(key, catalogue())}")
    return look


@cache
def _forms(look: Look) -> Mapping[Look, Asset]:
    """One body at rest and at each phase of each gait, all in one box.

    A track keeps its size when a person stops or runs, and the trunk moves smoothly: the box holds all
    forms, and its middle lies ahead of the body's axis by the same length in each. KITTI's labels do the
    same: one size for a person's whole track, 0.84 x 0.66 x 1.76 m on average and up to 1.09 m long in its
    training sequences. A man of 1.76 m fills 0.97 m walking and 1.07 m with running: too little more to
    give up that every return lies within the box.
    """
    family = FAMILIES[look.name]
    shells = {pose: _used(family.make(pose, Variety(pose))) for pose in family.poses(look)}
    low, high = _bounds([shell.vertices for shell in shells.values()])
    middle = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    placed = {pose: shell.placed(-middle) for pose, shell in shells.items()}
    low, high = _bounds([shell.vertices.astype(np.float32) for shell in placed.values()])
    length, width, height = (high - low).tolist()
    return {pose: _asset(pose.key, family.kind, s, (length, width, height)) for pose, s in placed.items()}


def _bounds(points: Sequence[F32 | F64]) -> tuple[F64, F64]:
    """Lowest and highest coordinates of all points, (3,) each."""
    low, high = np.min([p.min(0) for p in points], 0), np.max([p.max(0) for p in points], 0)
    return low, high


def _used(shell: Shell) -> Shell:
    """The shell without vertices that no triangle has."""
    seen = np.zeros(len(shell.vertices), bool)
    seen[shell.triangles.ravel()] = True
    return Shell(shell.vertices[seen], (np.cumsum(seen) - 1)[shell.triangles], shell.reflectivity)


def _asset(key: str, kind: Kind, shell: Shell, size: tuple[float, float, float]) -> Asset:
    vertices, triangles = shell.vertices.astype(np.float32), shell.triangles.astype(np.int32)
    reflectivity = shell.reflectivity.astype(np.float32)
    for array in (vertices, triangles, reflectivity):
        array.flags.writeable = False  # assets are shared
    return Asset(key, kind, vertices, triangles, size, reflectivity)


@dataclass(frozen=True, eq=False)
class Asset:
    """A closed surface with a kind, in its actor frame.

    Args:
        vertices: (v, 3) [m]. triangles: (t, 3), facing outwards.
        size: length, width, height [m] of a box that is centred over x = y = 0 and rests on z = 0. Of what
            has no gait, exactly the bounds of the vertices; else the bounds over all gaits and phases.
        reflectivity: (t,) diffuse, 0..1, at 905 nm.
    """

    key: str
    kind: Kind
    vertices: F32
    triangles: I32
    size: tuple[float, float, float]
    reflectivity: F32
