"""The kinds of bodies that there are: what each is called, how it is made, how it moves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from datmo.messages import Kind
from sim.scene.bodies import bicycle, bus, cars, person, powered
from sim.scene.bodies import truck as trucks
from sim.scene.bodies.gait import GAIT_PHASES, GAITS
from sim.scene.bodies.primitives import Shell
from sim.scene.bodies.variety import Look, Variety

WALK, RIDE = "walk", "ride"


@dataclass(frozen=True, eq=False)
class Family:
    """All meshes of a kind.

    Attributes:
        words: what each variant is. make: the shell of a look.
        gaits: the names of its gaits, each of GAIT_PHASES phases; keys leave the first one's name out.
        cycle: metres gone in a cycle of a gait; 0 for what has none.
    """

    kind: Kind
    name: str
    words: tuple[str, ...]
    make: Callable[[Look, Variety], Shell]
    gaits: tuple[str, ...] = ()
    cycle: Callable[[Look, Variety], float] = field(default=lambda _look, _variety: 0.0)

    def poses(self, look: Look) -> tuple[Look, ...]:
        """One body in all its forms: standing, and at each phase of each gait."""
        moving = (
            replace(look, gait=named(self.gaits, gait), phase=phase)
            for gait in self.gaits
            for phase in range(GAIT_PHASES)
        )
        return look.still, *moving

    def has(self, look: Look) -> bool:
        """Whether there is such a variant, gait and phase."""
        gaits = {named(self.gaits, gait) for gait in self.gaits}
        moving = look.phase is not None and look.phase < GAIT_PHASES and look.gait in gaits
        return look.variant < len(self.words) and (moving or look == look.still)


def named(gaits: tuple[str, ...], gait: str) -> str:
    """What a key says of a gait: nothing of the first one."""
    return "" if gait == gaits[0] else gait


def _person(look: Look, variety: Variety) -> Shell:
    return person.person(look.variant, look.phase, look.gait or WALK, variety)


FAMILIES = {
    family.name: family
    for family in (
        Family(Kind.CAR, "car", cars.CAR_WORDS, lambda look, luck: cars.car(look.variant, luck)),
        Family(Kind.VAN, "van", cars.VAN_WORDS, lambda look, luck: cars.van(look.variant, luck)),
        Family(Kind.TRUCK, "truck", trucks.TRUCK_WORDS, lambda look, luck: trucks.truck(look.variant, luck)),
        Family(
            Kind.PEDESTRIAN, "pedestrian", person.PERSON_WORDS, _person, tuple(GAITS),
            lambda look, luck: person.stride(look.variant, look.gait or WALK, luck),
        ),
        Family(Kind.BUS, "bus", bus.BUS_WORDS, lambda look, luck: bus.bus(look.variant, luck)),
        Family(
            Kind.MOTORCYCLE, "motorcycle", powered.MOTORCYCLE_WORDS,
            lambda look, luck: powered.motorcycle(look.variant, luck),
        ),
        Family(
            Kind.BICYCLE, "bicycle", bicycle.BICYCLE_WORDS,
            lambda look, luck: bicycle.bicycle(look.variant, look.phase, luck), (RIDE,),
            lambda _look, _luck: bicycle.DEVELOPMENT,
        ),
    )
}  # fmt: skip
