"""The parts of a person, each from its joint: legs, arms, trunk, head, skirt.

Segment lengths are Drillis and Contini's shares of height (D. A. Winter, Biomechanics and Motor Control
of Human Movement, fig. 4.1). Frame: x ahead, y left, z up, the hip joints at height 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from datmo.arrays import F64
from sim.scene.bodies import materials as m
from sim.scene.bodies.primitives import Shell, box, ellipsoid, join, loft, tube

THIGH, SHANK, UPPER_ARM, FOREARM, HAND = 0.245, 0.246, 0.186, 0.146, 0.09  # shares of height
SHOULDER = (0.106, 0.285)  # to the side, of girth; above the hip, of height
NECK, CHIN = 0.3, 0.3425  # above the hip
HEAD = 0.128  # from chin to crown


@dataclass(frozen=True)
class Person:
    """A person's looks.

    Attributes:
        height: [m], in shoes. girth: share of an average person's. cloth: which of `materials.CLOTH`.
        head: size of the head over an adult's of this height; 1.25 at six years, 1.12 at ten (H. Gray,
            Anatomy: the head is a sixth of the height of a child of six, 1/7.5 of an adult's).
        hem: how far a skirt or coat hangs down from the hip, share of height; 0 none.
    """

    height: float
    girth: float
    cloth: int
    backpack: bool = False
    head: float = 1.0
    hem: float = 0.0
    hair: float = m.HAIR

    @property
    def scale(self) -> float:
        """Height of the adult whose trunk and limbs these are [m]."""
        return self.height / (1.0 + HEAD * (self.head - 1.0))


@dataclass(frozen=True)
class Pose:
    """Joint angles of one side [rad]: hip, knee, toes up, shoulder, elbow."""

    hip: float
    knee: float
    ankle: float
    shoulder: float
    elbow: float


def ahead(angle: float) -> F64:
    """A unit vector that hangs down at 0 and points ahead (x) at pi / 2."""
    return np.array([np.sin(angle), 0.0, -np.cos(angle)])


def pitched(angle: float) -> F64:
    """The turn (3, 3) that lifts what lies ahead by `angle` [rad]; a negative one bows."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])


def leg(p: Person, pose: Pose, side: int) -> Shell:
    """Thigh, shank and shoe, from the hip joint at the origin's height, y to the left."""
    h, g = p.scale, p.scale * p.girth
    hip = np.array([0.0, side * 0.052 * g, 0.0])
    knee = hip + THIGH * h * ahead(pose.hip)
    ankle = knee + SHANK * h * ahead(pose.hip - pose.knee)
    cloth = m.TROUSERS[p.cloth]
    upper = np.stack([hip + np.array([0, 0, 0.03 * h]), hip + 0.4 * (knee - hip), knee])
    bend = 0.1 * (knee - ankle)  # the shank begins within the thigh, so that no gap opens
    lower = np.stack([knee + bend, knee + 0.3 * (ankle - knee), ankle])
    sole = box((0.035 * h, 0.0, -0.029 * h), (0.152 * h, 0.055 * g, 0.02 * h), m.SHOE)
    instep = tube(
        np.array([[-0.03, 0, -0.012], [0.03, 0, -0.012], [0.1, 0, -0.02]]) * h,
        np.array([[0.026, 0.026], [0.024, 0.028], [0.012, 0.024]]) * g,
        m.SHOE,
    )
    return join(
        [
            tube(upper, np.array([0.05, 0.047, 0.034]) * g, cloth),
            tube(lower, np.array([0.035, 0.033, 0.022]) * g, cloth),
            join([sole, instep]).placed(ankle, pitched(pose.hip - pose.knee + pose.ankle)),
        ]
    )


def arm(p: Person, pose: Pose, side: int) -> Shell:
    """An arm that hangs or swings from the shoulder."""
    h = p.scale
    shoulder = np.array([0.0, side * SHOULDER[0] * h * p.girth, SHOULDER[1] * h])
    lean = np.array([0.0, side * 0.09, 0.0])
    elbow = shoulder + UPPER_ARM * h * (ahead(pose.shoulder) + lean)
    wrist = elbow + FOREARM * h * ahead(pose.shoulder + pose.elbow)
    tip = wrist + HAND * h * ahead(pose.shoulder + pose.elbow + 0.1)
    return arm_through(p, shoulder, elbow, wrist, tip)


def arm_through(p: Person, shoulder: F64, elbow: F64, wrist: F64, tip: F64) -> Shell:
    """Upper arm, forearm and hand through four joints, (3,) each [m]."""
    h, g = p.scale, p.scale * p.girth
    top = np.array([0.0, 0.0, 0.024 * h])
    upper = np.stack([shoulder + top, shoulder + 0.6 * top, shoulder - 0.3 * top, elbow])
    return join(
        [
            tube(upper, np.array([0.012, 0.024, 0.03, 0.024]) * g, m.CLOTH[p.cloth]),
            tube(np.stack([elbow, wrist]), np.array([0.026, 0.018]) * g, m.CLOTH[p.cloth]),
            tube(
                np.stack([wrist, 0.5 * (wrist + tip), tip]),
                np.array([[0.016, 0.012], [0.024, 0.013], [0.01, 0.006]]) * g,
                m.SKIN,
            ),
        ]
    )


@lru_cache(maxsize=64)
def trunk(p: Person) -> Shell:
    """Hips to shoulders as a loft of ellipses (depth, width), and what is carried on the back."""
    h, g = p.scale, p.scale * p.girth
    levels = np.array([-0.04, 0.0, 0.06, 0.1, 0.2, 0.27, 0.3, 0.315])
    depth = np.array([0.05, 0.066, 0.062, 0.057, 0.068, 0.06, 0.042, 0.025]) * g
    width = np.array([0.07, 0.098, 0.09, 0.083, 0.1, 0.108, 0.088, 0.035]) * g
    turn = 2 * np.pi * np.arange(14) / 14
    rings = np.stack(
        [
            np.outer(depth, np.cos(turn)),
            np.outer(width, np.sin(turn)),
            np.broadcast_to(levels[:, None] * h, (8, 14)),
        ],
        -1,
    )
    shade = np.full((7, 14), m.CLOTH[p.cloth])
    shade[:2] = m.TROUSERS[p.cloth]
    parts = [loft(rings, shade)]
    if p.backpack:
        parts.append(ellipsoid((-0.085 * h, 0, 0.19 * h), (0.11 * h, 0.17 * h, 0.25 * h), m.CLOTH[0], 10))
    return join(parts)


@lru_cache(maxsize=64)
def head(p: Person) -> Shell:
    """Neck, face and hair."""
    h, g, k = p.scale, p.scale * p.girth, p.scale * p.head

    def above(z: float) -> float:
        return CHIN * h + (z - CHIN) * k

    return join(
        [
            tube(np.array([[0, 0, 0.3], [0.008, 0, 0.36]]) * h, np.array([0.033, 0.032]) * g, m.SKIN),
            ellipsoid((0.012 * k, 0, above(0.405)), (0.108 * k, 0.086 * k, 0.125 * k), m.SKIN),
            ellipsoid((-0.004 * k, 0, above(0.417)), (0.108 * k, 0.093 * k, 0.106 * k), p.hair),
        ]
    )


def skirt(p: Person, left: Pose, right: Pose) -> Shell:
    """A skirt, or the tails of a coat, that hangs around both thighs down to the hem."""
    h, g = p.scale, p.scale * p.girth
    turn = 2 * np.pi * np.arange(14) / 14
    rings = []
    for share in (-0.35, 0.0, 0.35, 0.7, 1.0):
        drop = share * p.hem
        along = max(drop, 0.0) * h
        xs = [along * float(np.tan(pose.hip)) for pose in (left, right)]
        deep = abs(xs[0] - xs[1]) / 2 + (0.069 + 0.02 * max(share, 0.0)) * g
        wide = (0.098 + 0.025 * max(share, 0.0)) * g
        rings.append(
            np.column_stack([sum(xs) / 2 + deep * np.cos(turn), wide * np.sin(turn), np.full(14, -drop * h)])
        )
    return loft(np.stack(rings), m.COAT[p.cloth])
