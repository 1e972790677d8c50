"""Closed forms of the layers that stand in a place: height over s (along) and t (to the left) [m]."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from datmo.arrays import F64
from scenarios.spec import layers as spec

BELL = 6.0  # a Gaussian hill ends here, in standard deviations: exp(-18) of its height is left
EVER = float("inf")

Shape = Callable[[Any, F64, F64, float], F64]


def bump(u: F64) -> F64:
    """cos²(pi u / 2) for |u| < 1, else 0: level and smooth at top and foot."""
    return np.asarray(np.where(np.abs(u) < 1, np.cos(np.pi / 2 * np.clip(u, -1, 1)) ** 2, 0.0))


def trapezoid(s: F64, slope: float, top: float | None) -> F64:
    """0 up to s = 0, 1 after `slope`, level for `top`, and down to 0 again after another `slope`."""
    up = np.clip(s / slope, 0.0, 1.0)
    return up if top is None else np.minimum(up, np.clip((2 * slope + top - s) / slope, 0.0, 1.0))


def within(t: F64, width: float | None) -> F64:
    """1 where |t| is at most half the width, else 0."""
    return np.ones_like(t) if width is None else (np.abs(t) <= width / 2 + 1e-9).astype(float)


def crest(layer: spec.Crest | spec.Dip, s: F64, t: F64, _cell: float) -> F64:
    """h cos²(pi s / L) cos²(pi t / W) around the reference point."""
    top = layer.height if isinstance(layer, spec.Crest) else -layer.depth
    across = 1.0 if layer.width is None else bump(2 * t / layer.width)
    return top * bump(2 * s / layer.length) * across


def hill(layer: spec.Hill, s: F64, t: F64, _cell: float) -> F64:
    """h exp(-r² / 2 sigma²)."""
    return np.asarray(layer.height * np.exp(-(s * s + t * t) / (2 * layer.radius**2)))


def ramp(layer: spec.Ramp, s: F64, t: F64, _cell: float) -> F64:
    """Linear over `length`."""
    return layer.rise * trapezoid(s, layer.length, layer.plateau) * within(t, layer.width)


def step(layer: spec.Step, s: F64, t: F64, cell: float) -> F64:
    """Linear over one cell."""
    return layer.rise * trapezoid(s, cell, layer.plateau) * within(t, layer.width)


def washboard(layer: spec.Washboard, s: F64, t: F64, _cell: float) -> F64:
    """a sin(2 pi s / lambda), faded over one wave at either end."""
    wave = layer.wavelength
    fade = np.clip(np.minimum(s, layer.length - s) / wave, 0.0, 1.0)
    return layer.amplitude * fade * np.sin(2 * np.pi * s / wave) * within(t, layer.width)


def speed_bump(layer: spec.SpeedBump, s: F64, t: F64, _cell: float) -> F64:
    """An arc of chord L and sagitta h (Watts), h cos²(pi s / L), or a trapezoid."""
    L, h = layer.length, layer.height
    if layer.profile == "sinusoidal":
        z = h * bump(2 * s / L)
    elif layer.profile == "flat_top":
        z = h * trapezoid(s + L / 2, layer.ramp, L - 2 * layer.ramp)
    else:
        R = (L * L / 4 + h * h) / (2 * h)
        z = np.where(np.abs(s) < L / 2, np.sqrt(R * R - np.minimum(np.abs(s), L / 2) ** 2) - (R - h), 0.0)
    return z * within(t, layer.width)


def pothole(layer: spec.Pothole, s: F64, t: F64, _cell: float) -> F64:
    """-d (1 - (r/R)²)², level at the rim."""
    return -layer.depth * np.maximum(1 - (s * s + t * t) / layer.radius**2, 0.0) ** 2


FORMS: dict[type[Any], tuple[Shape, Callable[[Any], float]]] = {
    spec.Crest: (crest, lambda c: EVER if c.width is None else np.hypot(c.length, c.width) / 2),
    spec.Dip: (crest, lambda c: EVER if c.width is None else np.hypot(c.length, c.width) / 2),
    spec.Hill: (hill, lambda h: BELL * h.radius),
    spec.Ramp: (
        ramp,
        lambda r: EVER if r.width is None or r.plateau is None else 2 * r.length + r.plateau + r.width,
    ),
    spec.Step: (step, lambda s: EVER if s.width is None or s.plateau is None else 4 + s.plateau + s.width),
    spec.Washboard: (washboard, lambda w: w.length + w.width),
    spec.SpeedBump: (speed_bump, lambda b: b.length + b.width),
    spec.Pothole: (pothole, lambda p: p.radius),
}
"""Each kind's height, and the radius [m] around its place beyond which it is 0."""


def height(layer: Any, x: F64, y: F64, cell: float) -> F64:
    """Height [m] of a placed layer at world places x, y that broadcast against each other [m].

    Args:
        cell: spacing of the grid, over which a step rises [m].
    """
    form, _ = FORMS[type(layer)]
    heading = np.deg2rad(getattr(layer, "heading_deg", 0.0))
    c, sn = float(np.cos(heading)), float(np.sin(heading))
    dx, dy = x - layer.at[0], y - layer.at[1]
    return form(layer, dx * c + dy * sn, dy * c - dx * sn, cell)


def reach(layer: Any) -> float:
    """Radius [m] around its place beyond which a layer is 0; infinite where it never ends."""
    return float(FORMS[type(layer)][1](layer))
