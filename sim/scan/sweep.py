"""Lidar: one sweep of a real sensor over the world, as a scan and its truth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import perf_counter

import numpy as np

from datmo.arrays import F32, F64
from datmo.errors import ScenarioError, SimulationError
from datmo.messages import Relief, Scan, Truth
from scenarios import spec
from sim.scan.bodies import Body, body
from sim.scan.caster import Caster
from sim.scan.effects.chain import lasers, sensing
from sim.scan.embree import Mesh
from sim.scan.gather import gather
from sim.scan.luck import Luck
from sim.scan.mask import own_body
from sim.scan.pattern import pattern
from sim.scan.returns import Returns
from sim.scan.surface import surfaces
from sim.scan.things import place
from sim.scan.truth import relief, truth_of
from sim.scan.units import Unit, unit
from sim.scene.motion import Poses
from sim.scene.terrain import Terrain

STAGES = ("cast", "surfaces", "returns", "truth")
LASERS = 2**31
"""Key of the stream from which the lasers' biases and gains come; frames have theirs below."""


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


def _child(seed: np.random.SeedSequence, key: int) -> np.random.SeedSequence:
    return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, key))


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
        self._terrain_kind = terrain.mesh_kind
        self._things = place(things, terrain)
        static = None if self._things is None else self._things.mesh
        blind = own_body(self.pattern, sensor.body_mask)
        limits = calibrated.nearest, sensor.range
        self.caster = Caster(self.pattern, self._ground, static, limits, blind, bodies)
        each = lasers(sensor, calibrated.focus, calibrated.rings, _child(seed, LASERS))
        self._sense = sensing(sensor, self.pattern, blind, self._ground, limits, each)
        self._last: Returns | None = None
        self.milliseconds: dict[str, float] = {}

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
        `milliseconds` then tells how long each stage took.
        """
        stamp, times = index / self.rate, [perf_counter()]
        hits = self.caster.cast(poses, self.T_ego_sensor)
        times.append(perf_counter())
        bodies = [self._bodies(key) for key in poses.asset]
        met = surfaces(hits, self._terrain_kind, self._things, bodies, poses.kind)
        times.append(perf_counter())
        returns = self._sense(hits, met, Luck(_child(self._seed, index)))
        times.append(perf_counter())
        deskewed = self.sensor.deskew == "ego"
        got = gather(self.pattern, hits, met, returns, self._terrain, deskewed)
        scan = Scan(
            points=got.points,
            stamp=stamp,
            T_world_sensor=hits.motion.edge[-1].copy(),
            deskewed=deskewed,
            intensity=got.intensity,
            ring=got.ring,
            dt=got.dt,
        )
        truth = truth_of(hits, got, poses, bodies, stamp)
        times.append(perf_counter())
        self.milliseconds = dict(zip(STAGES, 1e3 * np.diff(times), strict=True))
        self._last = returns
        return scan, truth

    def range_image(self) -> tuple[F32, F32]:
        """Range [m] and intensity of the last sweep, (L, C) each, row 0 the top ring, 0 no return."""
        if self._last is None:
            raise SimulationError("there is no range image yet: no sweep was cast; call sweep() first")
        shape = (len(self.pattern.elevation), self.pattern.columns)
        return self._last.distance.reshape(shape).copy(), self._last.intensity.reshape(shape).copy()

    def relief(self, T_world_sensor: F64, xy: F64) -> Relief:
        """True ground at places (g, 2) [m, sensor], see `sim.scan.truth.relief`."""
        return relief(self._terrain, self._ground, T_world_sensor, self.eye, xy)
