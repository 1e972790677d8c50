"""A city bus: Mercedes-Benz Citaro (C628.087), from its technical information.

11.950 x 2.550 x 3.076 m, wheelbase 5.845 m, overhangs 2.705 and 3.400 m, floor 0.37 m above the road, waist
rail 0.95 m above the floor, tyres 275/70 R 22.5. EU 96/53/EC allows 13.5 x 2.55 x 4.0 m with two axles.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from sim.scene.bodies import materials as m
from sim.scene.bodies.primitives import Shell, box, join
from sim.scene.bodies.variety import NOMINAL, Variety
from sim.scene.bodies.vehicle import Body, Car, assembled, varied

PILLARS = np.linspace(0.3, 11.2, 9)
GLAZED = tuple((float(a) + 0.05, float(b) - 0.05) for a, b in pairwise(PILLARS))
CITARO = Body(
    11.950, 2.550, 0.3, (2.705, 8.55), 0.478, 0.275,
    top=((0, 1.15), (0.03, 1.25), (0.18, 2.65), (0.35, 2.88), (0.9, 2.9), (11.6, 2.9), (11.85, 2.8),
         (11.93, 1.6), (11.95, 1.1)),
    belt=((0, 0.95), (0.03, 1.05), (0.2, 1.32), (11.8, 1.32), (11.93, 1.3), (11.95, 0.9)),
    roof=((0, 0.9), (0.18, 0.9), (0.5, 0.93), (11.6, 0.93), (11.95, 0.92)),
    sides=((0, 0.92), (0.04, 0.96), (0.2, 1), (11.7, 1), (11.9, 0.98), (11.95, 0.95)),
    windows=GLAZED,
    screens=((0.03, 0.18), (11.85, 11.93)),
)  # fmt: skip
BUSES = (Car(CITARO, m.PAINT[0], 0.5, (0.5, 2.2)),)
BUS_WORDS = ("city bus",)
PLANT = (3.0, 1.7)  # length and width of the air conditioning on the roof [m]
PLANT_TOP = 3.076
WIDEST = 2.55


def bus(variant: int, variety: Variety = NOMINAL) -> Shell:
    """The bus `variant` of BUSES, front at x = length / 2."""
    car = varied(BUSES[variant], variety, WIDEST)
    roof = max(z for _, z in car.body.top)
    top = min(roof * PLANT_TOP / 2.9, 3.3)
    plant = box((0.1 * car.body.length, 0, (roof + top) / 2 - 0.05), (*PLANT, top - roof + 0.1), m.PAINT[0])
    return join([assembled(car), plant])
