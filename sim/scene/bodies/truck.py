"""Lorries: box trucks, and a tractor with its semi-trailer in one straight line.

EU 96/53/EC allows a rigid 12 m x 2.55 m x 4.0 m and an articulated vehicle 16.5 m, with at most 12.0 m from
the kingpin to the rear. Trucks 0 and 1 are as 12 t and 18 t rigids are sold (Mercedes-Benz Atego, MAN TGM
with a box body): 8.4 x 2.5 x 3.4 m and 10.6 x 2.55 x 3.8 m. Truck 2 is the usual 4x2 tractor (Mercedes-Benz
Actros 1845 LS: wheelbase 3.7 m, cab 2.3 m) before a 13.6 m box on three axles 1.31 m apart (Schmitz S.KO).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from sim.scene.bodies import materials as m
from sim.scene.bodies.primitives import Shell, box, join, wheel
from sim.scene.bodies.variety import NOMINAL, Variety
from sim.scene.bodies.vehicle import Body, hull

WHEEL_WIDTH = 0.28
LONGEST, HIGHEST = (12.0, 12.0, 16.5), 4.0  # [m]


@dataclass(frozen=True)
class Truck:
    """Measures of a lorry [m]; axles and what hangs between them are given by their distance from the front.

    Attributes:
        gap: from the cab to the box. twins: the axles with two tyres a side. tank: middle of the tanks.
        rails: from where to where a steel frame runs under the box, and its width.
        legs: landing legs of a trailer. sides: corners of a wheel.
        guard: from where to where side guards run (UNECE R73), two rails each.
    """

    length: float
    width: float
    height: float
    cab: float
    cab_height: float
    axles: tuple[float, ...]
    wheel_radius: float
    deck: float
    paint: float
    gap: float
    twins: tuple[int, ...]
    tank: float
    rails: tuple[float, float, float]
    legs: tuple[float, ...] = ()
    sides: int = 16
    guard: tuple[float, ...] = ()


TRUCKS = (
    Truck(8.4, 2.5, 3.4, 2.0, 2.55, (1.3, 5.9), 0.45, 1.05, m.PAINT[3], 0.15, (1,), 3.6, (0.65, 8.15, 0.9)),
    Truck(10.6, 2.55, 3.8, 2.2, 2.95, (1.4, 6.9, 8.25), 0.51, 1.15, m.PAINT[0], 0.15, (1, 2), 4.15,
          (0.65, 10.35, 0.9)),
    Truck(16.5, 2.55, 4.0, 2.3, 3.65, (1.4, 5.1, 10.85, 12.16, 13.47), 0.5, 1.2, m.PAINT[1], 0.6, (1,), 3.1,
          (0.65, 16.3, 0.9), (7.4,), 12, (7.9, 10.2)),
)  # fmt: skip
TRUCK_WORDS = ("box truck, two axles", "box truck, three axles", "lorry with semi-trailer")


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
    made = []
    for k, s in enumerate(t.axles):
        wide = 2 * WHEEL_WIDTH if k in t.twins else WHEEL_WIDTH
        y = t.width / 2 - wide / 2 - 0.02
        place = t.length / 2 - s
        made += [
            wheel((place, j * y, t.wheel_radius), t.wheel_radius, wide, m.TYRE, m.RIM, t.sides)
            for j in (1, -1)
        ]
    return made


def _guards(t: Truck) -> list[Shell]:
    """Two rails on either side, 0.6 and 0.9 m above the road."""
    made = []
    for start, end in zip(t.guard[::2], t.guard[1::2], strict=True):
        x, y = t.length / 2 - (start + end) / 2, t.width / 2 - 0.03
        made += [box((x, j * y, z), (end - start, 0.03, 0.12), m.TRIM) for j in (1, -1) for z in (0.6, 0.9)]
    return made


def _varied(t: Truck, longest: float, variety: Variety) -> Truck:
    """Another lorry of the same class: length behind the cab, height, cab and paint, within the law."""
    length = min(variety.below(t.length, 0.06), longest)
    height = min(variety.about(t.height, 0.05), HIGHEST)
    cab_height = min(variety.about(t.cab_height, 0.05), height)
    factor = (length - t.cab) / (t.length - t.cab)  # behind the cab; 1 for the nominal one

    def along(s: float) -> float:
        return s if s <= t.cab else t.cab + (s - t.cab) * factor

    return replace(
        t, length=length, height=height, cab_height=cab_height, axles=tuple(map(along, t.axles)),
        tank=along(t.tank), rails=(t.rails[0], along(t.rails[1]), t.rails[2]), legs=tuple(map(along, t.legs)),
        guard=tuple(map(along, t.guard)),
        paint=variety.about(variety.pick(t.paint, m.PAINT), 0.1),
    )  # fmt: skip


def truck(variant: int, variety: Variety = NOMINAL) -> Shell:
    """The truck `variant` of TRUCKS, front at x = length / 2."""
    t = _varied(TRUCKS[variant], LONGEST[variant], variety)
    front, rear = t.length / 2, -t.length / 2
    start = front - t.cab - t.gap
    cargo = start - rear
    tank, side = front - t.tank, t.width / 2
    rails = t.rails[1] - t.rails[0]
    frame = front - (t.rails[0] + t.rails[1]) / 2
    parts = [
        *_guards(t),
        _cab(t),
        box((rear + cargo / 2, 0, (t.deck + t.height) / 2), (cargo, t.width, t.height - t.deck), m.CARGO),
        box((frame, 0, 0.8), (rails, t.rails[2], t.deck - 0.6), m.STEEL),
        *(box((tank, j * (side - 0.3), 0.68), (1.3, 0.5, 0.5), m.STEEL) for j in (1, -1)),
        *(box((front - s, j * 0.9, 0.65), (0.15, 0.15, 1.2), m.STEEL) for s in t.legs for j in (1, -1)),
        box((rear + 0.1, 0, 0.5), (0.1, t.width - 0.1, 0.14), m.TRIM),
        *(box((rear + 0.3, j * 0.4, 0.7), (0.2, 0.08, 0.5), m.STEEL) for j in (1, -1)),
        box((rear + 0.04, 0, 0.68), (0.02, 0.52, 0.11), m.PLATE),
        *(box((rear + 0.1, j * (side - 0.25), 0.68), (0.1, 0.35, 0.14), m.LAMP) for j in (1, -1)),
        box((front - 0.01, 0, 0.62), (0.02, 0.52, 0.11), m.PLATE),
        *_wheels(t),
    ]
    return join(parts)
