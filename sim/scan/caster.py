"""Casting a sweep: terrain, things and moving bodies, and the exact account of who hides whom."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from datmo.arrays import F32, F64, I32, Bool
from datmo.geometry import inverse
from datmo.threads import blocks, groups, spread
from sim.scan.bodies import Body, body
from sim.scan.culling import candidates
from sim.scan.embree import Mesh
from sim.scan.merge import NOTHING, TERRAIN, THING, Found, account, contest, describe, nearer
from sim.scan.motion import SweepMotion, sweep_motion, world_rays
from sim.scan.pattern import Pattern
from sim.scene.motion import Poses

GROUP = 4
"""Actors that one thread casts at in one go."""


@dataclass(frozen=True, eq=False)
class Hits:
    """What each ray of a sweep met first; L * C rays, ring by ring, in firing order.

    Attributes:
        distance: (m,) along the ray [m], inf where it met nothing within range or is blind.
        winner: (m,) row of the actor, else `TERRAIN`, `THING` or `NOTHING`.
        triangle: (m,) row of the triangle in the winner's mesh, -1 none.
        normal: (m, 3) unit, towards the sensor [sensor at the stamp]; zeros where nothing was met.
        cosine: (m,) of the angle between the ray and the normal, 0..1.
        motion: of the sensor during the sweep.
        solo: (k,), visible: (k,), lost_to: (k, k + 2): as in `Truth`.
    """

    distance: F32
    winner: I32
    triangle: I32
    normal: F32
    cosine: F32
    motion: SweepMotion
    solo: I32
    visible: I32
    lost_to: I32


@dataclass(frozen=True, eq=False)
class Attempt:
    """What the rays that may meet some actors, from row `first` on, met of them.

    Those of the i-th are rows start[i] .. start[i + 1] of ray, distance [m], triangle (-1 missed),
    normal and direction of the ray [actor].
    """

    first: int
    start: I32
    ray: I32
    distance: F32
    triangle: I32
    normal: F32
    direction: F32


class Caster:
    """Casts sweeps at a static terrain, static things and moving bodies; the nearest hit wins.

    Rolling shutter is exact: each ray starts from the sensor's pose at its own column's time, and
    to meet an actor it is moved into the actor's frame at that time; nothing is ever rebuilt.

    Args:
        pattern: the rays. terrain: in the world. things: in the world, or None.
        limits: nearest and farthest that the sensor measures [m]; what stands nearer still blocks
            the ray. blind: (L, C) rays that the ego's own body takes; they meet nothing and count
            nowhere. bodies: the body of an asset key.
    """

    def __init__(
        self,
        pattern: Pattern,
        terrain: Mesh,
        things: Mesh | None,
        limits: tuple[float, float],
        blind: Bool,
        bodies: Callable[[str], Body] = body,
    ) -> None:
        self.pattern, self.blind, self._bodies = pattern, blind, bodies
        self._nearest, self._farthest = limits
        self._static = [(terrain, TERRAIN)] + ([] if things is None else [(things, THING)])
        self._reach = np.where(blind.ravel(), -1.0, self._farthest).astype(np.float32)

    def cast(self, poses: Poses, T_ego_sensor: F64) -> Hits:
        """What every ray of one sweep meets, and how many rays each actor won and lost."""
        motion = sweep_motion(self.pattern, poses, T_ego_sensor)
        T_sensor_world = inverse(motion.edge[-1])
        m, k = len(self._reach), len(poses)
        found = (
            self._reach.copy(),
            np.full(m, NOTHING, np.int32),
            np.empty(m, np.int32),
            np.empty((m, 3), np.float32),
            np.empty(m, np.float32),
        )
        bodies = [self._bodies(key) for key in poses.asset]
        attempts = spread(partial(self._at_actors, motion, poses, bodies), groups(k, GROUP))
        for a in attempts:
            contest(a.first, a.start, a.ray, (a.distance, a.triangle), found)
        spread(partial(self._at_static, motion, T_sensor_world, found), blocks(m))
        lost_to = np.zeros((k, k + 2), np.int32)
        moving = np.ascontiguousarray(poses.T_world_actor), motion.weight, T_sensor_world

        def count(a: Attempt) -> None:
            hit = a.distance, a.triangle, a.normal, a.direction
            account(a.first, a.start, a.ray, hit, moving, self._nearest, found, lost_to)

        spread(count, attempts)
        solo, visible = lost_to.sum(1, dtype=np.int32), lost_to.diagonal().copy()
        np.fill_diagonal(lost_to, 0)
        return Hits(*found, motion, solo, visible, lost_to)

    def _at_static(self, motion: SweepMotion, T_sensor_world: F64, found: Found, rays: slice) -> None:
        """Cast a block of rays at what stands still, as far as the nearest actor."""
        o, d = world_rays(self.pattern, motion, rays)
        distance, winner, triangle, normal = found[0][rays], found[1][rays], found[2][rays], found[3][rays]
        for mesh, name in self._static:
            casts = mesh.cast(o, d, distance.copy())
            nearer(name, (casts.distance, casts.triangle, casts.normal), distance, winner, triangle, normal)
        describe(rays.start, d, T_sensor_world, found)

    def _at_actors(self, motion: SweepMotion, poses: Poses, bodies: Sequence[Body], rows: slice) -> Attempt:
        """Cast at a group of actors the rays that may meet them."""
        T_wa, some = poses.T_world_actor[rows], bodies[rows]
        may = candidates(self.pattern, self.blind, motion, T_wa, some, self._farthest)
        distance = np.full(len(may.ray), self._farthest, np.float32)
        triangle, normal = np.empty(len(may.ray), np.int32), np.empty((len(may.ray), 3), np.float32)
        for i, one in enumerate(some):
            mine = slice(may.start[i], may.start[i + 1])
            casts = one.mesh.cast(may.origins[mine], may.directions[mine], distance[mine])
            triangle[mine], normal[mine] = casts.triangle, casts.normal
        return Attempt(rows.start, may.start, may.ray, distance, triangle, normal, may.directions)
