"""A motor scooter: Vespa Primavera 125, from its data sheet.

1.852 x 0.735 m, wheelbase 1.334 m, seat height 0.790 m, tyres 110/70-12 (0.23 m to the ground).
"""

from __future__ import annotations

from sim.scene.bodies import materials as m
from sim.scene.bodies.motorcycle import Motorcycle, block, rod
from sim.scene.bodies.primitives import Shell, box, ellipsoid, wheel
from sim.scene.bodies.rider import Seat

RADIUS = 0.23


def scooter(b: Motorcycle) -> tuple[list[Shell], Seat]:
    """Its parts, and where the rider sits: upright, both feet on the floor behind the shield."""
    front, rear = b.wheelbase / 2, -b.wheelbase / 2
    shield, column = front - 0.22, front - 0.3
    parts = [
        wheel((front, 0, RADIUS), RADIUS, 0.11, m.TYRE, m.RIM),
        wheel((rear, 0, RADIUS), RADIUS, 0.12, m.TYRE, m.RIM),
        ellipsoid((front - 0.02, 0, 0.36), (0.5, 0.2, 0.3), b.paint, 10),
        block(((rear - 0.26, 0.2, 0.5, 0.7), (rear - 0.1, 0.36, 0.32, 0.74), (rear + 0.2, 0.42, 0.26, 0.72),
               (-0.2, 0.34, 0.24, 0.7), (-0.12, 0.26, 0.26, 0.6)), b.paint),
        block(((rear - 0.16, 0.2, 0.7, 0.77), (rear + 0.1, 0.28, 0.68, 0.79), (-0.2, 0.26, 0.67, 0.78),
               (-0.06, 0.16, 0.66, 0.74)), m.TRIM),
        box((0.1, 0, 0.27), (0.56, 0.36, 0.09), m.TRIM),
        block(((shield - 0.04, 0.4, 0.28, 0.9), (shield, 0.5, 0.28, 0.9), (shield + 0.05, 0.3, 0.32, 0.9)),
              b.paint),
        block(((column - 0.06, 0.22, 0.9, 1.06), (column + 0.02, 0.3, 0.88, 1.08),
               (column + 0.1, 0.2, 0.9, 1.04)), b.paint),
        ellipsoid((column + 0.11, 0, 0.97), (0.08, 0.14, 0.14), m.LAMP, 8),
        box((column - 0.02, 0, 1.0), (0.04, 2 * b.bar, 0.04), m.TRIM),
        box((rear - 0.25, 0, 0.46), (0.02, 0.18, 0.18), m.PLATE),
        box((rear - 0.25, 0, 0.6), (0.04, 0.12, 0.08), m.LAMP),
        rod((front, 0, RADIUS), (shield + 0.02, 0, 0.8), 0.03, m.STEEL),
    ]  # fmt: skip
    for j in (1, -1):
        parts.append(rod((column - 0.02, j * 0.2, 1.0), (column, j * 0.29, 1.12), 0.007, m.TRIM))
        parts.append(ellipsoid((column, j * 0.3, 1.15), (0.03, 0.12, 0.09), m.TRIM, 8))
    foot = 0.14, 0.13, 0.31 + 0.039 * b.rider.scale
    hip = -0.3, 0.76 + 0.05 * b.rider.scale
    grip = column - 0.04, b.bar - 0.07, 1.04
    return parts, Seat(hip, 0.12, 0.0, grip, (foot, foot), 0.0)
