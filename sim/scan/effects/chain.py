"""What the sensor reports of a sweep: the measurement, then every effect in its order."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from datmo.arrays import F64, Bool
from scenarios import spec
from sim.scan.caster import Hits
from sim.scan.effects.air import air
from sim.scan.effects.edges import mix_edges
from sim.scan.effects.multipath import add_multipath
from sim.scan.effects.weather import add_weather
from sim.scan.embree import Mesh
from sim.scan.luck import Luck
from sim.scan.pattern import Pattern
from sim.scan.returns import Lasers, Returns, measure, response_of
from sim.scan.surface import Surfaces

Limits = tuple[float, float]


NEAREST_FOCUS = 5.0
"""A calibration that says less means no more than "near" [m]."""


def lasers(sensor: spec.Sensor, focus: F64 | None, rings: int, seed: np.random.SeedSequence) -> Lasers:
    """What differs from laser to laser; biases and gains are drawn once for the run.

    Args:
        focus: (rings,) of the receivers [m], None where the unit does not say.
    """
    one, other = (np.random.default_rng([*seed.generate_state(4), key]) for key in (0, 1))
    bias = (sensor.range_bias * one.standard_normal(rings)).astype(np.float32)
    sharp = np.zeros(rings) if focus is None else 1 / np.maximum(focus, NEAREST_FOCUS)
    return Lasers(bias, response_of(sensor.noise.response, rings, other), sharp.astype(np.float32))


def sensing(
    sensor: spec.Sensor,
    pattern: Pattern,
    blind: Bool,
    terrain: Mesh,
    limits: Limits,
    each: Lasers,
) -> Callable[[Hits, Surfaces, Luck], Returns]:
    """How this sensor turns what its rays met into returns.

    Noise and losses first, in clear or thick air; then edges mix, flanks mirror, what is in the air
    sends echoes of its own; last the bias of each laser. Truth knows nothing of any of it.

    Args:
        blind: (L, C) rays that the ego's own body takes. terrain: for mirrored rays.
        limits: nearest and farthest measured range [m]. each: what differs from laser to laser.
    """
    noise, weather = sensor.noise, air(sensor.weather, limits[1])

    def sense(hits: Hits, met: Surfaces, luck: Luck) -> Returns:
        returns = measure(hits, met, noise, weather.alpha, limits, each, luck)
        if noise.edges:
            mix_edges(pattern, hits, met, returns, 1e-3 * noise.divergence_mrad, limits[0], luck)
        if noise.multipath:
            add_multipath(pattern, hits, met, returns, terrain, limits[1], luck)
        if not weather.clear:
            add_weather(hits, met, blind.ravel(), returns, weather, limits, luck)
        if each.bias.any():
            image = returns.distance.reshape(len(each.bias), -1)
            image += np.where(image > 0, each.bias[:, None], np.float32(0))
        return returns

    return sense
