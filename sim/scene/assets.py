"""The catalogue of meshes: what actors look like to the sensor.

Keys: "car/0" .. "car/3", "van/0", "van/1", "truck/0", "truck/1", "pedestrian/<variant>/<phase>" for a walker
at a phase of its gait, "pedestrian/<variant>" for one who stands.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from datmo.arrays import F32, I32
from datmo.errors import SimulationError, nearest
from datmo.messages import Kind
from sim.scene.bodies import cars, person
from sim.scene.bodies import truck as trucks
from sim.scene.bodies.primitives import Shell

GAIT_PHASES = person.GAIT_PHASES
VARIANTS = {
    Kind.CAR: ("car", len(cars.CARS)),
    Kind.VAN: ("van", len(cars.VANS)),
    Kind.TRUCK: ("truck", len(trucks.TRUCKS)),
    Kind.PEDESTRIAN: ("pedestrian", len(person.PERSONS)),
}


def keys(kind: Kind) -> tuple[str, ...]:
    """Keys of the variants of a kind; those of pedestrians stand, add "/<phase>" for walking.

    Raises:
        SimulationError: the catalogue has no mesh of this kind.
    """
    if kind not in VARIANTS:
        raise SimulationError(
            f"there is no mesh of kind {Kind(kind).name}; choose one of {', '.join(k.name for k in VARIANTS)}"
        )
    name, count = VARIANTS[kind]
    return tuple(f"{name}/{i}" for i in range(count))


def car(variant: int) -> Asset:
    """Hatchback, saloon, sport utility or small car: 0 .. 3."""
    return asset(f"car/{variant}")


def van(variant: int) -> Asset:
    """Transporter or high van: 0, 1."""
    return asset(f"van/{variant}")


def truck(variant: int) -> Asset:
    """Box truck with two or three axles: 0, 1."""
    return asset(f"truck/{variant}")


def pedestrian(phase: int | None, variant: int) -> Asset:
    """A person 0 .. 3 at a phase 0 .. GAIT_PHASES - 1 of the gait, or standing; walks along +x."""
    return asset(f"pedestrian/{variant}" if phase is None else f"pedestrian/{variant}/{phase}")


def stride(variant: int) -> float:
    """Metres that a pedestrian walks in one gait cycle, that is in GAIT_PHASES phases."""
    asset(f"pedestrian/{variant}")  # refuses an unknown variant
    return person.stride(variant)


@cache
def asset(key: str) -> Asset:
    """The mesh of a key, made once in a process.

    Raises:
        SimulationError: there is no such key; the nearest are named.
    """
    known = _known()
    if key not in known:
        raise SimulationError(f"there is no asset {key!r}; {nearest(key, known)}")
    kind, make = known[key]
    return _centred(key, kind, make())


@cache
def _known() -> dict[str, tuple[Kind, Callable[[], Shell]]]:
    """How each key's shell is made."""
    makers = {Kind.CAR: cars.car, Kind.VAN: cars.van, Kind.TRUCK: trucks.truck}
    known: dict[str, tuple[Kind, Callable[[], Shell]]] = {
        key: (kind, partial(make, i)) for kind, make in makers.items() for i, key in enumerate(keys(kind))
    }
    for i, key in enumerate(keys(Kind.PEDESTRIAN)):
        known[key] = Kind.PEDESTRIAN, partial(person.person, i, None)
        for phase in range(GAIT_PHASES):
            known[f"{key}/{phase}"] = Kind.PEDESTRIAN, partial(person.person, i, phase)
    return known


def _centred(key: str, kind: Kind, shell: Shell) -> Asset:
    """Moved so that its bounds are centred over the origin and rest on z = 0."""
    used = shell.vertices[shell.triangles.ravel()]
    low, high = used.min(0), used.max(0)
    low[:2] = (low[:2] + high[:2]) / 2
    placed = shell.placed(-low)
    bounds = np.ptp(placed.vertices.astype(np.float32)[shell.triangles.ravel()], axis=0)
    return _asset(key, kind, placed, (float(bounds[0]), float(bounds[1]), float(bounds[2])))


def _asset(key: str, kind: Kind, shell: Shell, size: tuple[float, float, float]) -> Asset:
    used, triangles = np.unique(shell.triangles, return_inverse=True)
    arrays = (
        np.ascontiguousarray(shell.vertices[used], np.float32),
        np.ascontiguousarray(triangles.reshape(-1, 3), np.int32),
        np.ascontiguousarray(shell.reflectivity, np.float32),
    )
    for array in arrays:
        array.flags.writeable = False  # assets are shared
    return Asset(key, kind, arrays[0], arrays[1], size, arrays[2])


@dataclass(frozen=True, eq=False)
class Asset:
    """A closed surface with a kind, in its actor frame.

    Args:
        vertices: (v, 3) [m]. triangles: (t, 3), facing outwards.
        size: length, width, height [m], exactly the bounds of the vertices, which are centred over
            x = y = 0 and rest on z = 0.
        reflectivity: (t,) diffuse, 0..1, at 905 nm.
    """

    key: str
    kind: Kind
    vertices: F32
    triangles: I32
    size: tuple[float, float, float]
    reflectivity: F32
