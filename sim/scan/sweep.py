"""Lidar: one sweep of a real sensor over the world, as a scan and its truth."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numba import njit

from datmo.arrays import F32, F64, I64
from datmo.errors import ScenarioError, SimulationError
from datmo.messages import Relief, Scan, Truth
from scenarios import spec
from sim.scan.bodies import Body, body
from sim.scan.caster import Caster
from sim.scan.embree import Mesh
from sim.scan.mask import own_body
from sim.scan.pattern import pattern
from sim.scan.returns import Returns, measure
from sim.scan.surface import surfaces
from sim.scan.things import place
from sim.scan.units import Unit, unit
from sim.scene.motion import Poses
from sim.scene.terrain import Terrain
from sim.truth import ground_below, relief, truth_of


def mount(sensor: spec.Sensor) -> F64:
    """T_ego_sensor: from the ego's centre on the ground; turned by yaw, then pitch, then roll."""
    r, p, y = np.deg2rad([sensor.roll_deg, sensor.pitch_deg, sensor.yaw_deg])
    T_ego_sensor = np.eye(4)
    T_ego_sensor[:3, :3] = [
        [
            np.cos(y) * np.cos(p),
            np.cos(y) * np.sin(p) * np.sin(r) - np.sin(y) * np.cos(r),
            np.cos(y) * np.sin(p) * np.cos(r) + np.sin(y) * np.sin(r),
        ],
        [
            np.sin(y) * np.cos(p),
            np.sin(y) * np.sin(p) * np.sin(r) + np.cos(y) * np.cos(r),
            np.sin(y) * np.sin(p) * np.cos(r) - np.cos(y) * np.sin(r),
        ],
        [-np.sin(p), np.cos(p) * np.sin(r), np.cos(p) * np.cos(r)],
    ]
    T_ego_sensor[:3, 3] = sensor.forward, sensor.left, sensor.height
    return T_ego_sensor


def unit_of(sensor: spec.Sensor) -> Unit:
    """The unit that a scenario asks for.

    Raises:
        ScenarioError: there is none, its table is wrong, or it does not see that far.
    """
    asked = unit(sensor.unit)
    if sensor.range > asked.farthest:
        raise ScenarioError(
            f"sensor.range is {sensor.range:g} m; {sensor.unit} measures up to {asked.farthest:g} m; lower it"
        )
    return asked


@njit(cache=True, nogil=True)
def _points(o: F64, d: F64, T: F64, rays: I64, distance: F32, out: F64) -> None:
    """Points at `distance` along each ray, taken by its column's T (C, 4, 4)."""
    C = len(T)
    for n in range(len(rays)):
        ring, c = rays[n] // C, rays[n] % C
        r = distance[rays[n]]
        x, y, z = (
            o[ring, c, 0] + r * d[ring, c, 0],
            o[ring, c, 1] + r * d[ring, c, 1],
            o[ring, c, 2] + r * d[ring, c, 2],
        )
        for i in range(3):
            out[n, i] = T[c, i, 0] * x + T[c, i, 1] * y + T[c, i, 2] * z + T[c, i, 3]


class Lidar:
    """A calibrated sensor on the ego's roof.

    Args:
        sensor: its description. rate: sweeps a second [Hz]. terrain: the ground.
        things: static things of the scenario. seed: of the noise; frame k draws from its own
            stream (seed, k), so that it does not depend on the frames before it.
        bodies: the body of an asset key.

    Raises:
        ScenarioError: the unit is unknown, or does not see that far.
    """

    def __init__(
        self,
        sensor: spec.Sensor,
        rate: float,
        terrain: Terrain,
        things: Sequence[spec.Thing],
        seed: np.random.SeedSequence,
        bodies: Callable[[str], Body] = body,
    ) -> None:
        self.sensor, self.rate, self._terrain, self._seed, self._bodies = sensor, rate, terrain, seed, bodies
        calibrated = unit_of(sensor)
        self.pattern = pattern(calibrated, rate, sensor.encoder)
        self.T_ego_sensor = mount(sensor)
        self.eye = np.array([0.0, 0.0, calibrated.vertical_offset.mean()])
        self._ground = Mesh(terrain.vertices, terrain.triangles)
        self._terrain_kind = np.ascontiguousarray(terrain.kind).ravel()
        self._things = place(things, terrain)
        static = None if self._things is None else self._things.mesh
        blind = own_body(self.pattern, sensor.body_mask)
        self.caster = Caster(self.pattern, self._ground, static, sensor.range, blind, bodies)
        self._last: Returns | None = None

    @staticmethod
    def shape(sensor: spec.Sensor, rate: float) -> tuple[int, int]:
        """Rings, and firings of each in a sweep at `rate` [Hz]: (64, 2083) for an HDL-64E at 10 Hz.

        Raises:
            ScenarioError: the unit is unknown, or does not see that far.
        """
        asked = unit_of(sensor)
        return asked.rings, asked.columns(rate)

    def sweep(self, poses: Poses, index: int) -> tuple[Scan, Truth]:
        """The sweep that ends at `index` / rate, and its truth.

        Points are ring by ring from the top in firing order. With `deskew: ego` they are the
        places measured, in the sensor frame at the stamp; with `none` each is in the sensor frame
        at its own time. Ground truth heights are in the sensor frame at the stamp in both cases.
        """
        C, stamp = self.pattern.columns, index / self.rate
        hits = self.caster.cast(poses, self.T_ego_sensor)
        bodies = [self._bodies(key) for key in poses.asset]
        met = surfaces(hits, self._terrain_kind, self._things, bodies, poses.kind)
        rng = np.random.default_rng(
            np.random.SeedSequence(self._seed.entropy, spawn_key=(*self._seed.spawn_key, index))
        )
        noise = self.sensor.noise
        returns = measure(hits, met.reflectivity, met.level, noise, self.sensor.range, rng)
        rays = np.flatnonzero(returns.hit)
        T_world_sensor = hits.motion.edge[-1].copy()
        at_stamp = self._places(hits.motion.T_stamp_sensor, rays, returns.distance)
        deskewed = self.sensor.deskew == "ego"
        still = np.broadcast_to(np.eye(4), (C, 4, 4))
        points = at_stamp if deskewed else self._places(np.ascontiguousarray(still), rays, returns.distance)
        scan = Scan(
            points=points.astype(np.float32),
            stamp=stamp,
            T_world_sensor=T_world_sensor,
            deskewed=deskewed,
            intensity=returns.intensity[rays],
            ring=(rays // C).astype(np.uint8),
            dt=self.pattern.time[rays % C].astype(np.float32),
        )
        height = ground_below(self._terrain, T_world_sensor, at_stamp).astype(np.float32)
        self._last = returns
        return scan, truth_of(hits, met, returns.hit, height, poses, bodies, stamp, C)

    def range_image(self) -> tuple[F32, F32]:
        """Range [m] and intensity of the last sweep, (L, C) each, row 0 the top ring, 0 no return."""
        if self._last is None:
            raise SimulationError("there is no range image yet: no sweep was cast; call sweep() first")
        shape = (len(self.pattern.elevation), self.pattern.columns)
        return self._last.distance.reshape(shape).copy(), self._last.intensity.reshape(shape).copy()

    def relief(self, T_world_sensor: F64, xy: F64) -> Relief:
        """True ground at places (g, 2) [m, sensor], see `sim.truth.relief`."""
        return relief(self._terrain, self._ground, T_world_sensor, self.eye, xy)

    def _places(self, T: F64, rays: I64, distance: F32) -> F64:
        out = np.empty((len(rays), 3))
        _points(self.pattern.origins, self.pattern.directions, T, rays, distance, out)
        return out
