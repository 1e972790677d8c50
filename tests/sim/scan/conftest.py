from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from datmo.arrays import F32, F64, I32
from datmo.messages import Kind
from sim.scan.bodies import Body, body_of
from sim.scan.pattern import Pattern, pattern
from sim.scan.units import Unit
from sim.scene.motion import Poses, edges


@dataclass(frozen=True)
class Shape:
    vertices: F32
    triangles: I32
    size: tuple[float, float, float]
    reflectivity: F32


def box(length: float, width: float, height: float) -> Shape:
    """A closed box on z = 0 around x = y = 0, counter-clockwise from outside."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (0, 1)], float)
    vertices = (corners * np.array([length / 2, width / 2, height])).astype(np.float32)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.int32)
    return Shape(vertices, triangles, (length, width, height), np.full(12, 0.4, np.float32))


def at(x: float, y: float, z: float, yaw: float, pitch: float = 0.0) -> F64:
    c, s, p, q = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[p, 0, q], [0, 1, 0], [-q, 0, p]])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, (x, y, z)
    return T


Motion = Callable[[float], F64]


def poses_of(grid: Pattern, ego: Motion, actors: list[tuple[str, Motion]]) -> Poses:
    """Poses of one sweep from functions of the time relative to the stamp."""
    time = edges(grid.columns, grid.period)
    k = len(actors)
    return Poses(
        time=time,
        T_world_ego=np.array([ego(t) for t in time]),
        T_world_actor=np.array([[f(t) for t in time] for _, f in actors]).reshape(k, len(time), 4, 4),
        id=np.arange(10, 10 + k),
        kind=np.array([Kind.PEDESTRIAN if n == "ped" else Kind.CAR for n, _ in actors], np.uint8),
        asset=tuple(n for n, _ in actors),
        velocity=np.array([(f(0.0) - f(-0.01))[:2, 3] / 0.01 for _, f in actors]).reshape(k, 2),
    )


@pytest.fixture(scope="session")
def kit() -> SimpleNamespace:
    """What the tests build scenes with: `box`, `at`, `poses_of`."""
    return SimpleNamespace(box=box, at=at, poses_of=poses_of)


@pytest.fixture(scope="session")
def bodies() -> Callable[[str], Body]:
    made = {"car": box(4.5, 1.8, 1.5), "ped": box(0.4, 0.5, 1.75), "plate": box(0.02, 20.0, 3.0)}
    built = {name: body_of(shape) for name, shape in made.items()}
    return built.__getitem__


@pytest.fixture(scope="session")
def coarse() -> Pattern:
    """A sensor of 64 lasers on one point, at the slowest column count that is still a sweep."""
    zero = np.zeros(64)
    return pattern(Unit("ideal", np.deg2rad(np.linspace(2.0, -24.8, 64)), zero, zero, zero), 20.0)
