"""The presets of scenery around a crossing, and one sweep of an HDL-64E in them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, F64, I32, U8
from datmo.messages import Kind
from scenarios import spec
from scenarios.spec.scenery import PRESETS
from sim.picture.gallery.cloud import HEIGHT, NOISE, hdl64
from sim.picture.gallery.view import colours, looking, mesh_view, splat
from sim.picture.grounds import HALF, roads
from sim.picture.terrain import COLOURS
from sim.scan.embree import Mesh
from sim.scene.assets import asset
from sim.scene.scenery.parking import Parked, parked
from sim.scene.scenery.place import Standing, stand
from sim.scene.scenery.scatter import scatter
from sim.scene.terrain import Terrain, build_terrain

SHAPE = 320, 600
NIGHT, NEAREST = (22, 25, 31), 3.5  # what is nearer the ego's own body hides [m]
DEEP = -30.0  # of the floor: no ground reaches down to it [m]
EGO = np.array([2.0, -22.0])
ABOVE, AHEAD = np.array([-16.0, -30.0, 17.0]), np.array([0.0, 12.0])
"""From the ego to the eye, and to where it looks [m]."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Ground, things and parked vehicles as one mesh; `colour` (t, 3) of its triangles."""

    vertices: F32
    triangles: I32
    colour: F64


def presets() -> tuple[str, ...]:
    """Names of the presets that set anything."""
    return tuple(name for name, rules in PRESETS.items() if rules)


def scene(name: str) -> Scene:
    """A preset on 80 m by 80 m of rough ground with two roads."""
    area = -HALF, -HALF, HALF, HALF
    layers = [{"kind": "kerb"}] if name == "street" else []
    model = spec.Terrain.model_validate({"cell": 0.25, "roughness": "D", "layers": layers})
    lanes, seed = roads(), np.random.SeedSequence(2)
    ground = build_terrain(model, lanes, area, seed)
    scenery = spec.Scenery(preset=name, parking=(spec.Parking(),) if name == "street" else ())
    standing = parked(scenery, lanes, seed, area)
    things = scatter(scenery, lanes, ground, area, seed, [one.corners for one in standing])
    parts = [_ground(ground), *(_thing(stand(thing, ground)) for thing in things)]
    parts += [_vehicle(one, ground) for one in standing]
    first = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])], dtype=np.int32)
    return Scene(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.triangles + k for part, k in zip(parts, first, strict=True)]),
        np.concatenate([part.colour for part in parts]),
    )


def pictures(name: str) -> tuple[U8, U8]:
    """The scene as the eye sees it and as the sensor does (h, w, 3), from the same place."""
    made = scene(name)
    target = np.append(EGO + AHEAD, 0.0)
    view = looking(np.append(EGO, 0.0) + ABOVE, target, 62.0, SHAPE)
    rays, d = hdl64(), hdl64().directions.reshape(-1, 3)
    o = rays.origins.reshape(-1, 3) + np.append(EGO, HEIGHT)
    hits = Mesh(made.vertices, made.triangles).cast(o.astype(np.float32), d.astype(np.float32))
    met = (hits.triangle >= 0) & (hits.distance > NEAREST)
    reach = hits.distance[met] + np.random.default_rng(0).normal(0, NOISE, int(met.sum()))
    dots = 1.15 * made.colour[hits.triangle[met]]
    points = o[met] + reach[:, None] * d[met]
    seen = mesh_view(made.vertices, made.triangles, made.colour, view, DEEP)
    return seen, splat(view, points, dots, NIGHT)


def _ground(ground: Terrain) -> Scene:
    table = np.zeros((len(Kind), 3))
    for kind, colour in COLOURS.items():
        table[kind] = colour
    return Scene(ground.vertices, ground.triangles, np.repeat(table[ground.mesh_kind], 2, 0))


def _thing(one: Standing) -> Scene:
    return Scene(one.vertices, one.triangles, colours(one.kind, one.reflectivity))


def _vehicle(one: Parked, ground: Terrain) -> Scene:
    made = asset(one.asset)
    c, s = np.cos(one.yaw), np.sin(one.yaw)
    x, y, z = made.vertices.astype(float).T
    height = ground.height_at(one.xy[None])[0]
    vertices = np.column_stack([c * x - s * y + one.xy[0], s * x + c * y + one.xy[1], z + height])
    kind = np.full(len(made.triangles), made.kind, np.uint8)
    return Scene(vertices.astype(np.float32), made.triangles, colours(kind, made.reflectivity))
