from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest

from datmo.messages import FalseReturn, Kind, Scan, Truth
from scenarios import spec
from sim.scan.bodies import Body
from sim.scan.effects.multipath import mirror
from sim.scan.pattern import pattern
from sim.scan.sweep import Lidar
from sim.scan.units import unit
from sim.scene.terrain import Terrain, build_terrain

UNIT = "hdl64e-s3-xiesc"
SEED = np.random.SeedSequence(12)
OFF = spec.IDEAL.model_dump(exclude={"divergence_mrad"})


@pytest.fixture(scope="module")
def plain() -> Terrain:
    return build_terrain(spec.Terrain(cell=2.0), (), (-90, -90, 90, 90), np.random.SeedSequence(0))


@pytest.fixture(scope="module")
def cast(
    kit: SimpleNamespace, bodies: Callable[[str], Body], plain: Terrain
) -> Callable[..., tuple[Scan, Truth, Lidar]]:
    def sweep(index: int = 1, weather: spec.Weather | None = None, bias: float = 0.0, **noise: float | bool):
        sensor = spec.Sensor(
            unit=UNIT,
            noise=spec.Noise(**noise),
            weather=weather or spec.Weather(),
            range_bias=bias,
            body_mask=False,
        )
        one = Lidar(sensor, 20.0, plain, (), SEED, bodies)
        actors = [("car", lambda _, i=i: kit.at(6 + 2 * i, 4 * i - 8, 0, 0.3 * i)) for i in range(5)]
        poses = kit.poses_of(pattern(unit(UNIT), 20), lambda t: kit.at(5 * t, 0, 0, 0), actors)
        return *one.sweep(poses, index), one

    return sweep


def ranges(lidar: Lidar) -> np.ndarray:
    return lidar.range_image()[0]


def test_all_off_is_the_ideal_sensor(cast: Callable[..., tuple[Scan, Truth, Lidar]]) -> None:
    scan, truth, one = cast(**OFF)
    again, _, other = cast(index=9, **OFF)
    np.testing.assert_array_equal(ranges(one), ranges(other))
    assert not truth.cause.any()
    assert np.isnan(truth.lost.range).sum() == len(truth.lost.ring)
    ground = truth.is_ground
    assert np.abs(scan.points[ground, 2] - truth.height[ground]).max() < 1e-4
    assert len(np.unique(scan.intensity[ground & (scan.ring == 40)])) <= 2  # by incidence alone
    assert again.intensity.tobytes() == scan.intensity.tobytes()


@pytest.mark.parametrize("switch", OFF)
def test_one_effect_off_leaves_the_luck_of_the_others(
    cast: Callable[..., tuple[Scan, Truth, Lidar]], switch: str
) -> None:
    """Rays that the effect did not touch are as they were."""
    (one, _, with_it), (other, _, without) = cast(), cast(**{switch: OFF[switch]})
    full, less = ranges(with_it), ranges(without)
    both = (full > 0) & (less > 0)
    same = (full == less)[both].mean()
    if switch in ("intensity", "response"):
        np.testing.assert_array_equal(full, less)
        assert (one.intensity != other.intensity).any()
    else:
        assert (full != less).any()
    assert same > 0.97 or switch == "range_std"
    if switch == "range_std":
        assert np.abs(full - less)[both].max() < 0.9
        assert ((full > 0) == (less > 0)).mean() > 0.999


def test_false_returns_are_told(cast: Callable[..., tuple[Scan, Truth, Lidar]]) -> None:
    scan, truth, _ = cast(weather=spec.Weather(snow_mm_h=2))
    false = truth.cause > 0
    assert set(np.unique(truth.cause)) >= {FalseReturn.NONE, FalseReturn.SNOW}
    np.testing.assert_array_equal(false, truth.kind == Kind.FALSE_RETURN)
    assert (truth.actor[false] == -1).all()
    assert not truth.is_ground[false].any()
    assert np.isfinite(truth.height).all()
    assert len(scan) + len(truth.lost.ring) == 64 * unit(UNIT).columns(20)
    assert (truth.returns == np.bincount(truth.actor[truth.actor >= 0], minlength=5)).all()


def test_the_lasers_biases_are_their_own_and_stay(cast: Callable[..., tuple[Scan, Truth, Lidar]]) -> None:
    clean, biased, later = (
        ranges(cast(index=i, bias=b, **OFF)[2]) for i, b in ((1, 0.0), (1, 0.02), (5, 0.02))
    )
    hit = clean > 0
    bias = [np.median((biased - clean)[ring][hit[ring]]) for ring in range(64) if hit[ring].any()]
    assert 0.01 < np.std(bias) < 0.03
    np.testing.assert_array_equal(biased, later)
    spread = np.array([np.ptp((biased - clean)[ring][hit[ring]]) for ring in range(64) if hit[ring].any()])
    assert spread.max() < 1e-4


def test_a_mirror_keeps_the_tangent_and_turns_the_normal() -> None:
    d, n = np.array([[0.6, 0.0, -0.8]]), np.array([[-1.0, 0.0, 0.0]])
    np.testing.assert_allclose(mirror(d, n), [[-0.6, 0.0, -0.8]])


def test_mirrored_echoes_lie_below_the_ground_by_the_law_of_mirrors(
    cast: Callable[..., tuple[Scan, Truth, Lidar]],
) -> None:
    """On a plane, a vertical flank mirrors the ray: from height h it falls on by h / |dz|."""
    found = 0
    for index in range(12):
        scan, truth, one = cast(index=index, **{**OFF, "multipath": True})
        ideal = ranges(cast(**OFF)[2])
        image = ranges(one)
        rows = np.flatnonzero((image != ideal).ravel())
        C = image.shape[1]
        for row in rows:
            ring, c = divmod(int(row), C)
            o, d = one.pattern.origins[ring, c], one.pattern.directions[ring, c]
            h = 1.73 + (o + ideal[ring, c] * d)[2]
            if d[2] < -0.02 and h < 1.45:  # a flank, not the roof
                assert image[ring, c] == pytest.approx(ideal[ring, c] + h / -d[2], abs=0.2)
                found += 1
        assert (truth.cause > 0).sum() == len(rows)
        below = scan.points[truth.cause > 0, 2] - truth.height[truth.cause > 0]
        assert (below < 0.05).all()
    assert found >= 5
