"""The motorcycles of the catalogue with their riders."""

from __future__ import annotations

from dataclasses import replace

from sim.scene.bodies import materials as m
from sim.scene.bodies.figure import Person
from sim.scene.bodies.motorcycle import Motorcycle, naked
from sim.scene.bodies.primitives import Shell, join
from sim.scene.bodies.rider import rider
from sim.scene.bodies.scooter import scooter
from sim.scene.bodies.variety import NOMINAL, Variety

MOTORCYCLES = (
    (Motorcycle(Person(1.76, 1.12, 2), 1.415, 0.4, m.PAINT[3]), naked),
    (Motorcycle(Person(1.7, 1.05, 1), 1.334, 0.35, m.PAINT[0]), scooter),
)
MOTORCYCLE_WORDS = ("motorcycle with rider", "motor scooter with rider")


def varied(b: Motorcycle, variety: Variety) -> Motorcycle:
    """Another one like it: rider, wheelbase, handlebar, paint."""
    p = b.rider
    person = replace(
        p,
        height=variety.about(p.height, 0.04),
        girth=variety.about(p.girth, 0.06),
        cloth=variety.pick(p.cloth, tuple(range(len(m.CLOTH)))),
    )
    return replace(
        b,
        rider=person,
        wheelbase=variety.about(b.wheelbase, 0.03),
        bar=variety.about(b.bar, 0.05),
        paint=variety.about(variety.pick(b.paint, m.PAINT), 0.1),
    )


def motorcycle(variant: int, variety: Variety = NOMINAL) -> Shell:
    """The motorcycle `variant` of MOTORCYCLES with its rider, tyres on z = 0; +x ahead."""
    machine, make = MOTORCYCLES[variant]
    b = varied(machine, variety)
    parts, seat = make(b)
    return join([*parts, rider(b.rider, seat, m.HELMET)])
