"""Which mesh a body shows: at rest, or a phase of walking, running or pedalling."""

from __future__ import annotations

from functools import cache

import numpy as np

from datmo.messages import Kind
from sim.scene import assets

CHILD = 1.5  # who is smaller is a child [m]
STAND = 0.05  # slower than this is standing [m/s]
RUN = 2.2
"""Faster than this is running [m/s]; people change gait at about 2 m/s (A. Hreljac, Preferred and
energetically optimal gait transition speeds in human locomotion, Med. Sci. Sports Exerc. 25 (1993) 1158)."""


def looks_of(age: str) -> tuple[str, ...]:
    """Keys of the standing meshes of an age: `adult`, `child` or `any`."""
    everyone = assets.keys(Kind.PEDESTRIAN)
    if age == "any":
        return everyone
    return tuple(k for k in everyone if (assets.asset(k).size[2] < CHILD) == (age == "child"))


def cycles(looks: str, kind: Kind, distance: float, speed: float) -> float:
    """Gait cycles that a way of `distance` [m] takes at a speed [m/s]; none for what has no gait."""
    length = _cycle(looks, _gait(kind, speed))
    return distance / length if length else 0.0


def key(looks: str, kind: Kind, cycle: float, speed: float) -> str:
    """The mesh of a body at a place in its gait cycle (for people, whole numbers are heel strikes)."""
    gait = _gait(kind, speed)
    if speed <= STAND or not _cycle(looks, gait):
        return looks
    return _phase(looks, int(np.floor(cycle * assets.GAIT_PHASES)) % assets.GAIT_PHASES, gait)


def _gait(kind: Kind, speed: float) -> str:
    return "run" if kind == Kind.PEDESTRIAN and speed > RUN else ""


@cache
def _cycle(looks: str, gait: str) -> float:
    return assets.cycle(assets.at_phase(looks, 0, gait)) if assets.cycle(looks) else 0.0


@cache
def _phase(looks: str, phase: int, gait: str) -> str:
    return assets.at_phase(looks, phase, gait)
