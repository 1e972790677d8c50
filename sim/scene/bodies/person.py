"""Persons who stand, walk and run: head and trunk, arms that swing against legs that step.

Adults' heights are within the 5th to 95th percentiles of Fryar et al., "Anthropometric Reference Data for
Children and Adults: United States", NCHS Vital and Health Statistics 3(46): men 1.63-1.88 m, women
1.50-1.73 m without shoes. Children have the median heights of the CDC growth charts (2000): 1.155 m at
six years, 1.385 m at ten; the smallest and largest of them here lie within the 5th to 95th percentiles.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim.scene.bodies import materials as m
from sim.scene.bodies.figure import Person, Pose, arm, head, leg, pitched, skirt, trunk
from sim.scene.bodies.gait import GAIT_PHASES, STANDING, Gait, gait
from sim.scene.bodies.primitives import Shell, join
from sim.scene.bodies.variety import NOMINAL, Variety

PERSONS = (
    Person(1.76, 1.0, 0),
    Person(1.64, 0.95, 1),
    Person(1.22, 1.02, 2),
    Person(1.84, 1.2, 3, backpack=True),
    Person(1.155, 1.04, 1, head=1.25),
    Person(1.385, 0.98, 0, head=1.12),
    Person(1.65, 0.95, 3, hem=0.24),
    Person(1.78, 1.1, 2, hem=0.2),
)
PERSON_WORDS = (
    "man", "woman", "child", "man with a backpack", "child of six", "child of ten", "woman in a skirt",
    "man in a coat",
)  # fmt: skip


def varied(variant: int, variety: Variety) -> Person:
    """The person `variant` of PERSONS, or another like it: height, girth, cloth, hair."""
    p = PERSONS[variant]
    return replace(
        p,
        height=variety.about(p.height, 0.06),
        girth=variety.about(p.girth, 0.1),
        cloth=variety.pick(p.cloth, tuple(range(len(m.CLOTH)))),
        hair=variety.about(p.hair, 0.5),
    )


def _figure(p: Person, left: Pose, right: Pose, lean: float) -> Shell:
    """Everything but the ground under it: the hip joints lie at height 0."""
    upper = join([trunk(p), head(p), arm(p, left, 1), arm(p, right, -1)])
    tails = [skirt(p, left, right)] if p.hem else []
    return join([upper.placed((0.0, 0.0, 0.0), pitched(-lean)), leg(p, left, 1), leg(p, right, -1), *tails])


def _depth(p: Person, way: Gait, cycle: float) -> float:
    """How far the lower foot is below the hip [m]."""
    legs = leg(p, way.pose(cycle), 1), leg(p, way.pose(cycle + 0.5), -1)
    return -float(min(made.vertices[:, 2].min() for made in legs))


def person(variant: int, phase: int | None, name: str = "walk", variety: Variety = NOMINAL) -> Shell:
    """The person `variant` of PERSONS at a phase of 0 .. GAIT_PHASES - 1 of a gait, or standing.

    It moves along +x, with the pelvis over x = y = 0. While a foot stands, the lowest point lies at z = 0, so
    that the hips rise and fall as they do in walking; while a runner flies, the hips follow a throw.
    """
    p = varied(variant, variety)
    if phase is None:
        shell = _figure(p, STANDING, STANDING, 0.0)
        return shell.placed((0.0, 0.0, -shell.vertices[:, 2].min()))
    way, cycle = gait(name), phase / GAIT_PHASES
    shell = _figure(p, way.pose(cycle), way.pose(cycle + 0.5), way.lean)
    u = way.aloft(cycle)
    if u == 0.0:
        return shell.placed((0.0, 0.0, -shell.vertices[:, 2].min()))
    before, after = (
        _depth(p, way, way.toe_off + np.floor(2 * cycle) / 2),
        _depth(p, way, np.ceil(2 * cycle) / 2),
    )
    thrown = (1 - u) * before + u * after + 4 * u * (1 - u) * way.rise * p.height
    return shell.placed((0.0, 0.0, max(thrown, -float(shell.vertices[:, 2].min()))))


def stride(variant: int, name: str = "walk", variety: Variety = NOMINAL) -> float:
    """Metres of going per gait cycle, with gait "walk" or "run"."""
    return gait(name).stride * varied(variant, variety).height
