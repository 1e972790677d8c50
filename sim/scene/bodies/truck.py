"""Box trucks: a cab over the engine, a cargo box, a frame between twin wheels.

EU 96/53/EC allows 12 m x 2.55 m x 4.0 m; the variants are as 12 t and 18 t rigids are sold
(Mercedes-Benz Atego, MAN TGM with a box body): 8.4 x 2.5 x 3.4 m and 10.6 x 2.55 x 3.8 m.
"""

from __future__ import annotations

from dataclasses import dataclass

from sim.scene.bodies import materials as m
from sim.scene.bodies.primitives import Shell, box, join, wheel
from sim.scene.bodies.vehicle import Body, hull

WHEEL_WIDTH = 0.28


@dataclass(frozen=True)
class Truck:
    """Measures of a rigid truck [m]; axles and boxes are given by their distance from the front."""

    length: float
    width: float
    height: float
    cab: float
    cab_height: float
    axles: tuple[float, ...]
    wheel_radius: float
    deck: float
    paint: float


TRUCKS = (
    Truck(8.4, 2.5, 3.4, 2.0, 2.55, (1.3, 5.9), 0.45, 1.05, m.PAINT[3]),
    Truck(10.6, 2.55, 3.8, 2.2, 2.95, (1.4, 6.9, 8.25), 0.51, 1.15, m.PAINT[0]),
)


def _cab(t: Truck) -> Shell:
    h = t.cab_height
    body = Body(
        t.cab, t.width, 0.4, (t.axles[0],), t.wheel_radius, WHEEL_WIDTH,
        top=((0, 1.25), (0.05, 1.4), (0.22, h - 0.35), (0.4, h - 0.08), (0.8, h), (t.cab, h)),
        belt=((0, 1.2), (0.05, 1.33), (0.3, 1.38), (t.cab, 1.38)),
        roof=((0, 0.92), (0.22, 0.9), (t.cab, 0.92)),
        sides=((0, 0.9), (0.08, 0.97), (0.2, 1), (t.cab, 1)),
        windows=((0.3, 1.15),),
        screens=((0.05, 0.22),),
    )  # fmt: skip
    return hull(body, t.paint).placed((t.length / 2 - t.cab / 2, 0, 0))


def _wheels(t: Truck) -> list[Shell]:
    """Single tyres in front, twins behind."""
    made = []
    for k, s in enumerate(t.axles):
        wide = WHEEL_WIDTH if k == 0 else 2 * WHEEL_WIDTH
        y = t.width / 2 - wide / 2 - 0.02
        place = t.length / 2 - s
        made += [wheel((place, j * y, t.wheel_radius), t.wheel_radius, wide, m.TYRE, m.RIM) for j in (1, -1)]
    return made


def truck(variant: int) -> Shell:
    """The truck `variant` of TRUCKS, front at x = length / 2."""
    t = TRUCKS[variant]
    front, rear = t.length / 2, -t.length / 2
    start = front - t.cab - 0.15
    cargo = start - rear
    tank = front - (t.axles[0] + t.axles[1]) / 2
    parts = [
        _cab(t),
        box((rear + cargo / 2, 0, (t.deck + t.height) / 2), (cargo, t.width, t.height - t.deck), m.CARGO),
        box((-0.2, 0, 0.8), (t.length - 0.9, 0.9, t.deck - 0.6), m.STEEL),
        *(box((tank, j * (t.width / 2 - 0.3), 0.68), (1.3, 0.5, 0.5), m.STEEL) for j in (1, -1)),
        box((rear + 0.1, 0, 0.5), (0.1, t.width - 0.1, 0.14), m.TRIM),
        *(box((rear + 0.3, j * 0.4, 0.7), (0.2, 0.08, 0.5), m.STEEL) for j in (1, -1)),
        box((rear + 0.04, 0, 0.68), (0.02, 0.52, 0.11), m.PLATE),
        *(box((rear + 0.1, j * (t.width / 2 - 0.25), 0.68), (0.1, 0.35, 0.14), m.LAMP) for j in (1, -1)),
        box((front - 0.01, 0, 0.62), (0.02, 0.52, 0.11), m.PLATE),
        *_wheels(t),
    ]
    return join(parts)
