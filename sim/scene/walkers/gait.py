"""Which mesh a person shows: standing, or a phase of walking or running."""

from __future__ import annotations

import numpy as np

from datmo.messages import Kind
from sim.scene.assets import GAIT_PHASES, asset, keys, stride

CHILD = 1.5  # who is smaller is a child [m]
STAND = 0.05  # slower than this is standing [m/s]
RUN = 2.2
"""Faster than this is running [m/s]; people change gait at about 2 m/s (A. Hreljac, Preferred and
energetically optimal gait transition speeds in human locomotion, Med. Sci. Sports Exerc. 25 (1993) 1158)."""


def looks_of(age: str) -> tuple[str, ...]:
    """Keys of the standing meshes of an age: `adult`, `child` or `any`."""
    everyone = keys(Kind.PEDESTRIAN)
    if age == "any":
        return everyone
    return tuple(k for k in everyone if (asset(k).size[2] < CHILD) == (age == "child"))


def variant(looks: str) -> int:
    """The variant in the key of a standing person."""
    return int(looks.split("/")[1])


def cycles(looks: str, distance: float) -> float:
    """Gait cycles that a way of `distance` [m] takes."""
    return distance / stride(variant(looks))


def key(looks: str, cycle: float, speed: float) -> str:
    """The mesh of a person at a place in its gait cycle (whole numbers are heel strikes)."""
    return looks if speed <= STAND else f"{looks}/{int(np.floor(cycle * GAIT_PHASES)) % GAIT_PHASES}"
