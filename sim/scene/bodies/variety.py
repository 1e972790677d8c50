"""Keys of assets, and the luck that makes one body of a variant differ from the next.

A key reads name/variant[/gait][/phase][~seed]: "car/2", "car/2~17", "pedestrian/0/run/5~3".
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TypeVar
from zlib import crc32

import numpy as np

from datmo.errors import SimulationError

T = TypeVar("T")

SEEDS = 32
"""How many bodies a variant has: ~0, or nothing, is the nominal one."""
KEY = re.compile(r"([a-z]+)/(0|[1-9]\d?)(?:/([a-z]+))?(?:/(0|[1-9]\d?))?(?:~(0|[1-9]\d?))?")


@dataclass(frozen=True)
class Look:
    """A key taken apart; gait "" and phase None stand still."""

    name: str
    variant: int
    gait: str = ""
    phase: int | None = None
    seed: int = 0

    @property
    def key(self) -> str:
        """The key that says this, the nominal seed left out."""
        parts = [self.name, str(self.variant)]
        parts += [self.gait] if self.gait else []
        parts += [] if self.phase is None else [str(self.phase)]
        return "/".join(parts) + (f"~{self.seed}" if self.seed else "")

    @property
    def still(self) -> Look:
        """The same body at rest."""
        return replace(self, gait="", phase=None)


def parse(key: str) -> Look:
    """Take a key apart.

    Raises:
        SimulationError: it does not read as a key.
    """
    found = KEY.fullmatch(key)
    if found is None or int(found[5] or 0) >= SEEDS:
        raise SimulationError(
            f"there is no asset {key!r}; a key reads name/variant[/gait][/phase][~seed], seed below {SEEDS}"
        )
    phase = None if found[4] is None else int(found[4])
    return Look(found[1], int(found[2]), found[3] or "", phase, int(found[5] or 0))


class Variety:
    """Draws for one body; those of the nominal one are all in the middle.

    Args:
        look: its draws depend on the name, variant and seed, not on gait and phase.
    """

    def __init__(self, look: Look | None = None) -> None:
        text = "" if look is None else look.still.key
        self._rng = np.random.default_rng(crc32(text.encode()))
        self._strength = 1.0 if look is not None and look.seed else 0.0

    def about(self, value: float, spread: float) -> float:
        """`value` times 1 - spread .. 1 + spread."""
        return value * (1.0 + self._strength * spread * float(self._rng.uniform(-1, 1)))

    def below(self, value: float, spread: float) -> float:
        """`value` times 1 - spread .. 1, where `value` is the most that the law allows."""
        return value * (1.0 - self._strength * spread * float(self._rng.uniform(0, 1)))

    def pick(self, nominal: T, others: tuple[T, ...]) -> T:
        """`nominal`, or any of the others."""
        i = int(self._rng.integers(len(others)))
        return others[i] if self._strength else nominal


NOMINAL = Variety()
