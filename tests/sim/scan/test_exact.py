"""Hits far away against closed forms: to a millimetre at a hundred metres."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from sim.scan.bodies import Body
from sim.scan.caster import Caster, Hits
from sim.scan.embree import Mesh
from sim.scan.pattern import Pattern, pattern
from sim.scan.units import unit
from sim.scene.motion import Poses

FAR = 100.0
MILLIMETRE = 1e-3
BALL = trimesh.creation.icosphere(subdivisions=6, radius=4.0)
"""Its faces lie at most 0.4 mm within the sphere: edges of 0.11 m, e² / 8 r."""


@pytest.fixture(scope="module")
def grid() -> Pattern:
    return pattern(unit("hdl64e-s3-20171102"), 10)


def cast(grid: Pattern, poses: Poses, mesh: Mesh, bodies: dict[str, Body]) -> Hits:
    blind = np.zeros(grid.directions.shape[:2], bool)
    return Caster(grid, mesh, None, (0.9, 200.0), blind, bodies.__getitem__).cast(poses, np.eye(4))


def rays(grid: Pattern, hits: Hits, row: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Origin and direction [world, double precision], column and distance of the rays that a row won."""
    ring, column = np.nonzero(hits.winner.reshape(64, -1) == row)
    T = hits.motion.T_world_sensor[column]
    o = np.einsum("nij,nj->ni", T[:, :3, :3], grid.origins[ring, column]) + T[:, :3, 3]
    d = np.einsum("nij,nj->ni", T[:, :3, :3], grid.directions[ring, column])
    return o, d, column, hits.distance.reshape(64, -1)[ring, column].astype(float)


def on_sphere(o: np.ndarray, d: np.ndarray, middle: np.ndarray, radius: float) -> np.ndarray:
    """Distance to the near side of a sphere, NaN where it is passed."""
    to = o - middle
    b = np.einsum("ij,ij->i", to, d)
    with np.errstate(invalid="ignore"):
        return np.asarray(-b - np.sqrt(b**2 - np.einsum("ij,ij->i", to, to) + radius**2))


@pytest.mark.parametrize("away", [0.0, 2000.0])
@pytest.mark.parametrize("normal", [(-1, 0, 0), (-1, 0.4, 0.3), (-0.3, 0.1, 1)])
def test_a_plane_at_100_metres(kit: SimpleNamespace, grid: Pattern, normal: tuple, away: float) -> None:
    """Also 2 km along the drive, where single precision is coarser."""
    n = np.array(normal) / np.linalg.norm(normal)
    middle = np.array([away + FAR, 0.0, 0.0])
    side = np.cross(n, [0.3, 0.9, 0.2])
    side /= np.linalg.norm(side)
    corners = [
        middle + 400 * (a * side + b * np.cross(n, side)) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    mesh = Mesh(np.array(corners, np.float32), np.array([[0, 1, 2], [0, 2, 3]], np.int32))
    poses = kit.poses_of(grid, lambda t: kit.at(away + 10 * t, 0.2, 0, 0.3 * t, 0.02), [])
    o, d, _, got = rays(grid, cast(grid, poses, mesh, {}), -2)
    want = np.einsum("ij,j->i", middle - o, n) / np.einsum("ij,j->i", d, n)
    near = (want < 1.3 * FAR) & (np.abs(d @ n) > 0.2)
    assert near.sum() > 3000
    assert np.abs(got - want)[near].max() < MILLIMETRE


@pytest.mark.parametrize("speed", [0.0, 30.0])
def test_a_sphere_at_100_metres_stands_or_drives(kit: SimpleNamespace, grid: Pattern, speed: float) -> None:
    """Each ray meets it where it is at the ray's own time."""
    body = Body(
        Mesh(BALL.vertices.astype(np.float32), BALL.faces.astype(np.int32)),
        size=(8.0, 8.0, 8.0),
        center=np.zeros(3),
        radius=4.0,
        low=np.full(3, -4.0),
        high=np.full(3, 4.0),
        reflectivity=np.ones(len(BALL.faces), np.float32),
    )
    ground = Mesh(
        np.array([[-9, -9, -90], [9, -9, -90], [0, 9, -90]], np.float32), np.array([[0, 1, 2]], np.int32)
    )
    actors = [("ball", lambda t: kit.at(FAR, speed * t, 0, 0))]
    poses = kit.poses_of(grid, lambda t: kit.at(15 * t, 0, 0, 0), actors)
    o, d, column, got = rays(grid, cast(grid, poses, ground, {"ball": body}), 0)
    middle = np.column_stack([np.full(len(o), FAR), speed * grid.time[column], np.zeros(len(o))])
    want = on_sphere(o, d, middle, 4.0)
    inward = np.abs(np.einsum("ij,ij->i", o + want[:, None] * d - middle, d)) / 4.0
    square = inward > 0.5  # at its limb a face turns the 0.4 mm into more
    assert square.sum() > 100
    assert np.abs(got - want)[square].max() < MILLIMETRE
