from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from datmo.messages import Kind
from scenarios import spec
from sim.scan.bodies import Body
from sim.scan.pattern import pattern
from sim.scan.sweep import Lidar
from sim.scan.units import unit, unit_names
from sim.scene.terrain import build_terrain

Bodies = Callable[[str], Body]
ROUGH = build_terrain(
    spec.Terrain(grade=0.1, roughness="F", cell=2.0), [], (-90, -90, 90, 90), np.random.SeedSequence(9)
)


@given(
    name=st.sampled_from(unit_names()),
    pitch=st.floats(-30, 30),
    height=st.floats(0.5, 5),
    reach=st.floats(2, 100),
    deskew=st.sampled_from(["ego", "none"]),
    seed=st.integers(0, 2**32),
)
@settings(max_examples=14, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_sensor_gives_a_sound_sweep_twice_the_same(
    kit: SimpleNamespace, bodies: Bodies, name: str, pitch: float, height: float, reach: float, deskew: str,
    seed: int,
) -> None:  # fmt: skip
    sensor = spec.Sensor(unit=name, pitch_deg=pitch, height=height, range=reach, deskew=deskew)
    poses = kit.poses_of(
        pattern(unit(name), 20),
        lambda t: kit.at(12 * t, 0, 0.5, t, 0.1),
        [("car", lambda t: kit.at(8 + 9 * t, 2, 0.3, 0.5)), ("ped", lambda t: kit.at(-4, 3 + t, 0, 1.0))],
    )
    one, other = (Lidar(sensor, 20.0, ROUGH, (), np.random.SeedSequence(seed), bodies) for _ in range(2))
    scan, truth = one.sweep(poses, 4)
    again, same = other.sweep(poses, 4)
    assert scan == again
    assert truth == same
    assert np.isfinite(scan.points).all()
    assert np.isfinite(truth.height).all()
    distance, intensity = one.range_image()
    assert distance.max(initial=0) <= reach
    assert ((intensity >= 0) & (intensity <= 1)).all()
    np.testing.assert_array_equal(truth.is_ground, truth.kind == Kind.FIELD)
    np.testing.assert_array_equal(truth.solo, truth.visible + truth.lost_to.sum(1))
    before = scan.points.copy(), truth.normal.copy()
    one.sweep(poses, 5)
    assert np.array_equal(scan.points, before[0])
    assert np.array_equal(truth.normal, before[1])
    assert not np.shares_memory(distance, one.range_image()[0])
