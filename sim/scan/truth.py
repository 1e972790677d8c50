"""Truth of a scan: what every ray met, where every actor is, and the true ground."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit

from datmo.arrays import F64, I32
from datmo.geometry import transform
from datmo.messages import Boxes, Relief, Truth, visibility
from sim.scan.bodies import Body
from sim.scan.caster import Hits
from sim.scan.embree import Mesh
from sim.scan.gather import Gathered
from sim.scene.motion import Poses
from sim.scene.terrain import Terrain

CLEARANCE = 0.05
"""A place is exposed when its ray meets the terrain no more than this before it [m]."""


def true_boxes(poses: Poses, bodies: Sequence[Body]) -> Boxes:
    """The actors' boxes at the stamp [world]; the yaw is that of the actor's x axis seen from above."""
    T = poses.T_world_actor[:, -1]
    size = np.array([body.size for body in bodies], float).reshape(-1, 3)
    middle = np.column_stack([np.zeros((len(size), 2)), size[:, 2] / 2])
    center = np.einsum("kij,kj->ki", T[:, :3, :3], middle) + T[:, :3, 3]
    yaw = np.arctan2(T[:, 1, 0], T[:, 0, 0])
    return Boxes(center=center, size=size, yaw=yaw, velocity=poses.velocity, id=poses.id, kind=poses.kind)


def ground_below(terrain: Terrain, T_world_sensor: F64, points: F64) -> F64:
    """z [m, sensor] (n,) at which the line through each point along the sensor's z axis meets the ground.

    Args:
        points: (n, 3) [m, sensor at the stamp].
    """
    up = np.ascontiguousarray(T_world_sensor[:3, 2])
    return np.asarray(points[:, 2] + terrain.along(transform(T_world_sensor, points), up))


@njit(cache=True, nogil=True)
def _count(actor: I32, counts: I32) -> None:
    """How many returns each actor gave."""
    for n in range(len(actor)):
        if actor[n] >= 0:
            counts[actor[n]] += 1


def truth_of(hits: Hits, gathered: Gathered, poses: Poses, bodies: Sequence[Body], stamp: float) -> Truth:
    """Truth of one sweep's returns."""
    counts = np.zeros(len(poses), np.int32)
    _count(gathered.actor, counts)
    return Truth(
        boxes=true_boxes(poses, bodies),
        stamp=stamp,
        T_world_actor=poses.T_world_actor[:, -1],
        actor=gathered.actor,
        thing=gathered.thing,
        kind=gathered.kind,
        is_ground=gathered.is_ground,
        height=gathered.height,
        normal=gathered.normal,
        solo=hits.solo,
        visible=hits.visible,
        returns=counts,
        lost_to=hits.lost_to,
        visibility=visibility(hits.solo, hits.visible),
        lost=gathered.lost,
        cause=gathered.cause,
    )


def relief(terrain: Terrain, mesh: Mesh, T_world_sensor: F64, eye: F64, xy: F64) -> Relief:
    """True ground at places in the sensor frame.

    A place is exposed when the ray to it from `eye` meets no terrain more than `CLEARANCE` before
    it; whether a laser points there is not asked. Height is NaN, and the place not exposed, where
    the line along the sensor's z axis does not settle on the ground.

    Args:
        mesh: of the terrain. eye: (3,) optical centre [m, sensor]. xy: (g, 2) [m, sensor].
    """
    xy = np.asarray(xy, float)
    height = ground_below(terrain, T_world_sensor, np.column_stack([xy, np.zeros(len(xy))]))
    world = transform(T_world_sensor, np.column_stack([xy, np.nan_to_num(height)]))
    ray = world - transform(T_world_sensor, eye[None])
    distance = np.linalg.norm(ray, axis=1)
    origins = np.broadcast_to(transform(T_world_sensor, eye[None]), ray.shape).astype(np.float32)
    directions = (ray / np.maximum(distance, 1e-9)[:, None]).astype(np.float32)
    met = mesh.cast(origins, directions).distance
    exposed = np.isfinite(height) & (met >= distance - CLEARANCE)
    return Relief(xy=xy, height=height, exposed=exposed, kind=terrain.kind_at(world[:, :2]))
