"""A naked motorcycle: Honda CB500F, from its data sheet.

2.080 x 0.800 x 1.060 m, wheelbase 1.415 m, seat height 0.785 m, ground clearance 0.145 m, tyres 120/70-17 and
160/60-17 (0.30 and 0.31 m to the ground). The rider makes it 1.7 m high.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.scene.bodies import materials as m
from sim.scene.bodies.figure import Person
from sim.scene.bodies.primitives import Shell, box, ellipsoid, loft, tube, wheel
from sim.scene.bodies.rider import Seat


@dataclass(frozen=True)
class Motorcycle:
    """Rider, and measures [m] of the machine: wheelbase, half the handlebar; all else goes with them."""

    rider: Person
    wheelbase: float
    bar: float
    paint: float


def block(stations: tuple[tuple[float, float, float, float], ...], reflectivity: float) -> Shell:
    """A loft of octagons: (x, width, bottom, top) each [m]."""
    turn = 2 * np.pi * (np.arange(8) + 0.5) / 8
    rings = [
        np.column_stack(
            [
                np.full(8, x),
                w / 2 * np.cos(turn) / np.cos(np.pi / 8),
                (low + high) / 2 + (high - low) / 2 * np.sin(turn) / np.cos(np.pi / 8),
            ]
        )
        for x, w, low, high in stations
    ]
    return loft(np.stack(rings), reflectivity)


def rod(a: tuple[float, float, float], c: tuple[float, float, float], radius: float, rho: float) -> Shell:
    """A round bar from a to c [m]."""
    return tube(np.array([a, c]), np.full(2, radius), rho, 8)


def naked(b: Motorcycle) -> tuple[list[Shell], Seat]:
    """Its parts, and where the rider sits."""
    front, rear = b.wheelbase / 2, -b.wheelbase / 2
    head = front - 0.27
    parts = [
        wheel((front, 0, 0.3), 0.3, 0.12, m.TYRE, m.RIM, 20),
        wheel((rear, 0, 0.31), 0.31, 0.16, m.TYRE, m.RIM, 20),
        block(((-0.28, 0.3, 0.25, 0.55), (-0.15, 0.4, 0.16, 0.68), (0.2, 0.38, 0.16, 0.68),
                (0.32, 0.28, 0.25, 0.6)), m.ENGINE),
        block(((-0.2, 0.18, 0.62, 0.8), (-0.05, 0.24, 0.62, 0.92), (0.2, 0.3, 0.62, 0.98),
                (0.36, 0.24, 0.7, 0.92), (head, 0.1, 0.74, 0.88)), b.paint),
        block(((rear - 0.22, 0.1, 0.8, 0.86), (rear, 0.2, 0.72, 0.86), (-0.4, 0.26, 0.64, 0.8),
                (-0.12, 0.24, 0.6, 0.79)), m.TRIM),
        ellipsoid((head + 0.17, 0, 0.88), (0.2, 0.22, 0.24), m.LAMP, 8),
        box((head - 0.03, 0, 1.02), (0.04, 2 * b.bar, 0.04), m.TRIM),
        box((rear - 0.33, 0, 0.56), (0.02, 0.18, 0.2), m.PLATE),
        rod((rear - 0.31, 0, 0.6), (rear - 0.15, 0, 0.8), 0.03, m.TRIM),
        rod((rear - 0.1, -0.17, 0.42), (0.1, -0.17, 0.25), 0.055, m.STEEL),
    ]  # fmt: skip
    for j in (1, -1):
        parts.append(rod((front, j * 0.1, 0.3), (head, j * 0.1, 0.98), 0.028, m.STEEL))
        parts.append(rod((rear, j * 0.11, 0.31), (-0.25, j * 0.11, 0.42), 0.03, m.STEEL))
        parts.append(rod((head - 0.02, j * 0.25, 1.02), (head + 0.02, j * 0.31, 1.15), 0.008, m.TRIM))
        parts.append(box((head + 0.02, j * 0.31, 1.17), (0.03, 0.12, 0.08), m.TRIM))
        parts.append(box((-0.2, j * 0.24, 0.33), (0.07, 0.1, 0.03), m.TRIM))
    grip = b.wheelbase / 2 - 0.31, b.bar - 0.07, 1.06
    foot = -0.28, 0.25, 0.43
    hip = -0.26, 0.78 + 0.05 * b.rider.scale
    return parts, Seat(hip, 0.35, 0.1, grip, (foot, foot), -0.1)
