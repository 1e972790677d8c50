"""Casting a sweep: terrain, things and moving bodies, and the exact account of who hides whom."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, F64, I32, Bool
from sim.scan.bodies import Body, body
from sim.scan.culling import candidates
from sim.scan.embree import Casts, Mesh
from sim.scan.merge import NOTHING, TERRAIN, THING, account, contest, describe
from sim.scan.motion import SweepMotion, sweep_motion, world_rays
from sim.scan.pattern import Pattern
from sim.scan.pool import blocks, spread
from sim.scene.motion import Poses

MIN_RANGE = 0.9
"""Nearer than this the sensor gives no return [m]; what stands there still blocks the ray."""


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


class Caster:
    """Casts sweeps at a static terrain, static things and moving bodies; the nearest hit wins.

    Rolling shutter is exact: each ray starts from the sensor's pose at its own column's time, and
    to meet an actor it is moved into the actor's frame at that time; nothing is ever rebuilt.

    Args:
        pattern: the rays. terrain: in the world. things: in the world, or None.
        max_range: [m]. blind: (L, C) rays that the ego's own body takes; they meet nothing and
            count nowhere. bodies: the body of an asset key.
    """

    def __init__(
        self,
        pattern: Pattern,
        terrain: Mesh,
        things: Mesh | None,
        max_range: float,
        blind: Bool,
        bodies: Callable[[str], Body] = body,
    ) -> None:
        self.pattern, self.max_range, self.blind = pattern, float(max_range), blind
        self._terrain, self._things, self._bodies = terrain, things, bodies

    def cast(self, poses: Poses, T_ego_sensor: F64) -> Hits:
        """What every ray of one sweep meets, and how many rays each actor won and lost."""
        motion = sweep_motion(self.pattern, poses, T_ego_sensor)
        distance, winner, triangle, normal = self._static(motion)
        bodies = [self._bodies(key) for key in poses.asset]

        def at_actor(row: int) -> tuple[I32, Casts]:
            T_wa = poses.T_world_actor[row]
            ray, o, d = candidates(self.pattern, self.blind, motion, T_wa, bodies[row], self.max_range)
            casts = bodies[row].mesh.cast(o, d)
            hit = (casts.triangle >= 0) & (casts.distance <= self.max_range)
            return ray[hit], Casts(casts.distance[hit], casts.triangle[hit], casts.normal[hit])

        attempts = spread(at_actor, range(len(poses)))
        for row, (ray, casts) in enumerate(attempts):
            contest(row, ray, casts, distance, winner, triangle, normal)
        solo, visible, lost_to = account(
            [ray for ray, _ in attempts], [c.distance for _, c in attempts], winner, MIN_RANGE
        )
        cosine = describe(self.pattern, motion, poses.T_world_actor, winner, normal)
        return Hits(distance, winner, triangle, normal, cosine, motion, solo, visible, lost_to)

    def _static(self, motion: SweepMotion) -> tuple[F32, I32, I32, F32]:
        """Distance, winner, triangle and normal [world] of what stands still, for every ray."""
        o, d = world_rays(self.pattern, motion)
        blind, m = self.blind.ravel(), len(o)
        distance, winner = np.full(m, np.inf, np.float32), np.full(m, NOTHING, np.int32)
        triangle, normal = np.full(m, -1, np.int32), np.zeros((m, 3), np.float32)

        def at_block(rays: slice) -> None:
            for mesh, name in ((self._terrain, TERRAIN), (self._things, THING)):
                if mesh is None:
                    continue
                casts = mesh.cast(o[rays], d[rays])
                beats = (casts.triangle >= 0) & (casts.distance <= self.max_range)
                beats &= (casts.distance < distance[rays]) & ~blind[rays]
                distance[rays][beats] = casts.distance[beats]
                winner[rays][beats] = name
                triangle[rays][beats] = casts.triangle[beats]
                normal[rays][beats] = casts.normal[beats]

        spread(at_block, blocks(m))
        return distance, winner, triangle, normal
