"""Bicycles with their riders, at phases of the cranks.

28 inch wheels are 622 mm rims (ISO 5775) with 37 to 40 mm tyres, 0.345 m to the ground; touring bicycles are
1.75-1.85 m long with wheelbases of 1.05-1.12 m, handlebars of 0.58-0.64 m, cranks of 0.17 m, bottom brackets
0.28 m high, seat tubes at 72-73 degrees (data sheets of Gazelle, Kalkhoff, VSF; ISO 4210 for the terms).
The saddle is as high as lets the leg be almost straight at the lowest pedal. KITTI's 9 cyclists in ten
training sequences are 1.44-1.93 m long, 1.60-1.86 m high and 0.34-0.88 m wide. Spokes are left out: the beam
of a lidar is ten times as wide. A turn of the cranks takes 5.4 m of road (42 x 17 teeth).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim.scene.bodies import materials as m
from sim.scene.bodies.figure import SHANK, THIGH, Person
from sim.scene.bodies.gait import GAIT_PHASES
from sim.scene.bodies.primitives import Shell, box, ellipsoid, hoop, join, tube
from sim.scene.bodies.rider import Seat, rider
from sim.scene.bodies.variety import NOMINAL, Variety

CRANK, BRACKET, PEDAL_OUT = 0.17, 0.28, 0.13  # [m]
DEVELOPMENT = 5.4  # metres a turn of the cranks
EXTENDED = 0.97  # of the leg at the lowest pedal
ANKLE = (-0.12, 0.085)  # from the pedal, level foot [m]
TYRE, RIM = 0.04, 0.02  # depth of tyre and rim [m]


@dataclass(frozen=True)
class Bicycle:
    """Measures [m] and rider; the frame's x runs from the middle between the axles.

    Attributes:
        bar: (x, half width, z) of the grips. bracket: x of the cranks' axle. tilt: of the seat tube [rad].
        lean, nod: of the rider [rad].
    """

    rider: Person
    wheelbase: float
    radius: float
    bar: tuple[float, float, float]
    bracket: float
    tilt: float
    lean: float
    nod: float


BICYCLES = (
    Bicycle(Person(1.74, 1.0, 1), 1.08, 0.345, (0.27, 0.29, 1.1), -0.09, 0.31, 0.38, 0.1),
    Bicycle(Person(1.8, 0.95, 3, hair=m.HELMET), 1.03, 0.345, (0.37, 0.24, 1.0), -0.09, 0.29, 0.72, 0.3),
)
BICYCLE_WORDS = ("city bicycle with rider", "touring bicycle with rider")


def varied(variant: int, variety: Variety) -> Bicycle:
    """The bicycle `variant` of BICYCLES, or another: rider, wheelbase, handlebar."""
    b = BICYCLES[variant]
    p = b.rider
    person = replace(
        p,
        height=variety.about(p.height, 0.04),
        girth=variety.about(p.girth, 0.08),
        cloth=variety.pick(p.cloth, tuple(range(len(m.CLOTH)))),
    )
    grow = person.height / p.height
    bar = b.bar[0] * grow, variety.about(b.bar[1], 0.08), b.bar[2] * grow
    return replace(b, rider=person, wheelbase=variety.about(b.wheelbase, 0.025), bar=bar)


def _saddle(b: Bicycle) -> tuple[float, float]:
    """(x, z) of the hip joints: as far from the lowest pedal's ankle as the leg reaches comfortably."""
    foot = b.bracket + ANKLE[0], BRACKET - CRANK + ANKLE[1]
    far = EXTENDED * (THIGH + SHANK) * b.rider.scale
    along = np.sin(b.tilt), np.cos(b.tilt)  # backwards, upwards along the seat tube from the bracket
    dx, dz = b.bracket - foot[0], BRACKET - foot[1]
    half = dx * -along[0] + dz * along[1]
    s = -half + np.sqrt(half * half - (dx * dx + dz * dz - far * far))
    return b.bracket - float(s * along[0]), BRACKET + float(s * along[1])


def _frame(b: Bicycle, hip: tuple[float, float]) -> list[Shell]:
    """Tubes, saddle, handlebar, and tyres without spokes."""
    half, r = b.wheelbase / 2, b.radius
    seat = hip[0], hip[1] - 0.05 * b.rider.scale
    bar_x, bar_y, bar_z = b.bar
    neck = half - 0.2, 0.86
    low = b.bracket, BRACKET
    post = b.bracket + 0.75 * (seat[0] - b.bracket), BRACKET + 0.75 * (seat[1] - BRACKET)

    def rod(a: tuple[float, float], c: tuple[float, float], radius: float, y: float = 0.0) -> Shell:
        return tube(np.array([[a[0], y, a[1]], [c[0], y, c[1]]]), np.full(2, radius), m.STEEL, 6)

    return [
        *(hoop((x, 0, r), r, TYRE + RIM, 0.04, m.TYRE) for x in (half, -half)),
        *(hoop((x, 0, r), 0.05, 0.045, 0.09, m.STEEL, 8) for x in (half, -half)),
        rod(low, neck, 0.02),
        rod(post, (neck[0] - 0.01, neck[1] + 0.03), 0.018),
        rod(low, seat, 0.016),
        rod((half, r), neck, 0.014, 0.055),
        rod((half, r), neck, 0.014, -0.055),
        rod((neck[0] + 0.01, neck[1] - 0.05), (bar_x + 0.05, bar_z), 0.016),
        rod((-half, r), low, 0.012, 0.05),
        rod((-half, r), low, 0.012, -0.05),
        rod((-half, r), post, 0.01, 0.05),
        rod((-half, r), post, 0.01, -0.05),
        box((bar_x + 0.03, 0, bar_z), (0.04, 2 * bar_y + 0.06, 0.035), m.TRIM),
        ellipsoid((seat[0] + 0.02, 0, seat[1]), (0.27, 0.16, 0.07), m.TRIM, 8),
        box((-half - 0.02, 0, 0.74), (0.02, 0.06, 0.06), m.LAMP),
        box((neck[0] + 0.06, 0, 0.88), (0.05, 0.07, 0.07), m.LAMP),
    ]


def bicycle(variant: int, phase: int | None, variety: Variety = NOMINAL) -> Shell:
    """The bicycle `variant` of BICYCLES with its rider; +x ahead, tyres on z = 0.

    Phase 0 .. GAIT_PHASES - 1 of the cranks, at 0 the left one points ahead; None coasts there.
    """
    b = varied(variant, variety)
    hip = _saddle(b)
    turn = 2 * np.pi * (phase or 0) / GAIT_PHASES
    parts, feet = _frame(b, hip), []
    for side in (1, -1):
        x = b.bracket + side * CRANK * float(np.cos(turn))
        z = BRACKET - side * CRANK * float(np.sin(turn))
        y = side * (PEDAL_OUT - 0.06)
        feet.append((x + ANKLE[0], PEDAL_OUT, z + ANKLE[1]))
        parts.append(tube(np.array([[b.bracket, y, BRACKET], [x, y, z]]), np.full(2, 0.013), m.STEEL, 6))
        parts.append(box((x, side * PEDAL_OUT, z), (0.09, 0.1, 0.025), m.TRIM))
    grip = b.bar[0], b.bar[1], b.bar[2] + 0.03
    seat = Seat(hip, b.lean, b.nod, grip, (feet[0], feet[1]), 0.0)
    return join([*parts, rider(b.rider, seat)])
