"""Walking persons: head, trunk, arms that swing against legs that step.

Joint angles over the gait cycle, from heel strike (0) to the next of the same foot (1), follow the
mean curves of natural walking: D. A. Winter, Biomechanics and Motor Control of Human Movement,
appendix A, and J. Perry, Gait Analysis. Segment lengths are Drillis and Contini's shares of height
(Winter, fig. 4.1). A gait cycle of two steps covers 0.83 heights at a comfortable speed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from datmo.arrays import F64
from sim.scene.bodies import materials as m
from sim.scene.bodies.primitives import Shell, box, ellipsoid, join, loft, tube

GAIT_PHASES = 16
STRIDE = 0.83  # of the height, a cycle
CYCLE = np.array([0.0, 0.12, 0.3, 0.5, 0.6, 0.73, 0.87, 1.0])
HIP = np.array([28.0, 24.0, 5.0, -11.0, -3.0, 18.0, 31.0, 28.0])  # flexion [deg]
KNEE = np.array([4.0, 18.0, 9.0, 9.0, 35.0, 62.0, 28.0, 4.0])
ANKLE = np.array([0.0, -4.0, 8.0, 8.0, -16.0, -3.0, 1.0, 0.0])  # toes up
SHOULDER = (2.0, 22.0)  # mean and amplitude, forward [deg]
ELBOW = (22.0, 12.0)


@dataclass(frozen=True)
class Person:
    """Height and girth [m, share of an average person's], cloth, and what is carried."""

    height: float
    girth: float
    cloth: int
    backpack: bool = False


PERSONS = (
    Person(1.76, 1.0, 0),
    Person(1.64, 0.95, 1),
    Person(1.22, 1.02, 2),
    Person(1.84, 1.2, 3, backpack=True),
)


@dataclass(frozen=True)
class Pose:
    """Joint angles of one side [rad]: hip, knee, toes up, shoulder, elbow."""

    hip: float
    knee: float
    ankle: float
    shoulder: float
    elbow: float


STANDING = Pose(0.0, 0.02, 0.0, 0.02, 0.15)


def _walking(cycle: float) -> Pose:
    """One side at a share of its gait cycle; its arm swings with the other leg."""
    hip, knee, ankle = (
        float(np.radians(CubicSpline(CYCLE, joint, bc_type="periodic")(cycle % 1.0)))
        for joint in (HIP, KNEE, ANKLE)
    )
    swing = -np.cos(2 * np.pi * cycle)
    shoulder, elbow = (float(np.radians(mean + size * swing)) for mean, size in (SHOULDER, ELBOW))
    return Pose(hip, knee, ankle, shoulder, elbow)


def _ahead(angle: float) -> F64:
    """A unit vector that hangs down at 0 and points ahead (x) at pi / 2."""
    return np.array([np.sin(angle), 0.0, -np.cos(angle)])


def _leg(p: Person, pose: Pose, side: int) -> list[Shell]:
    """Thigh, shank and shoe, from the hip joint at the origin's height, y to the left."""
    h, g = p.height, p.height * p.girth
    hip = np.array([0.0, side * 0.052 * g, 0.0])
    knee = hip + 0.245 * h * _ahead(pose.hip)
    ankle = knee + 0.246 * h * _ahead(pose.hip - pose.knee)
    pitch = pose.hip - pose.knee + pose.ankle
    c, s = np.cos(pitch), np.sin(pitch)
    R = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
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
    return [
        tube(upper, np.array([0.05, 0.047, 0.034]) * g, cloth),
        tube(lower, np.array([0.035, 0.033, 0.022]) * g, cloth),
        join([sole, instep]).placed(ankle, R),
    ]


def _arm(p: Person, pose: Pose, side: int) -> list[Shell]:
    """Upper arm, forearm and hand from the shoulder."""
    h, g = p.height, p.height * p.girth
    shoulder = np.array([0.0, side * 0.106 * g, 0.285 * h])
    lean = np.array([0.0, side * 0.09, 0.0])
    elbow = shoulder + 0.186 * h * (_ahead(pose.shoulder) + lean)
    top = np.array([0.0, 0.0, 0.024 * h])
    upper = np.stack([shoulder + top, shoulder + 0.6 * top, shoulder - 0.3 * top, elbow])
    wrist = elbow + 0.146 * h * _ahead(pose.shoulder + pose.elbow)
    tip = wrist + 0.09 * h * _ahead(pose.shoulder + pose.elbow + 0.1)
    return [
        tube(upper, np.array([0.012, 0.024, 0.03, 0.024]) * g, m.CLOTH[p.cloth]),
        tube(np.stack([elbow, wrist]), np.array([0.026, 0.018]) * g, m.CLOTH[p.cloth]),
        tube(
            np.stack([wrist, 0.5 * (wrist + tip), tip]),
            np.array([[0.016, 0.012], [0.024, 0.013], [0.01, 0.006]]) * g,
            m.SKIN,
        ),
    ]


def _trunk(p: Person) -> list[Shell]:
    """Hips to shoulders as a loft of ellipses (depth, width), then neck, head, hair."""
    h, g = p.height, p.height * p.girth
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
    parts = [
        loft(rings, shade),
        tube(np.array([[0, 0, 0.3], [0.008, 0, 0.36]]) * h, np.array([0.033, 0.032]) * g, m.SKIN),
        ellipsoid((0.012 * h, 0, 0.405 * h), (0.108 * h, 0.086 * h, 0.125 * h), m.SKIN),
        ellipsoid((-0.004 * h, 0, 0.417 * h), (0.108 * h, 0.093 * h, 0.106 * h), m.HAIR),
    ]
    if p.backpack:
        parts.append(ellipsoid((-0.085 * h, 0, 0.19 * h), (0.11 * h, 0.17 * h, 0.25 * h), m.CLOTH[0], 10))
    return parts


def person(variant: int, phase: int | None) -> Shell:
    """The person `variant` of PERSONS at a phase of 0 .. GAIT_PHASES - 1, or standing; walks along +x.

    The lowest point lies at z = 0, so that the hips rise and fall as they do in walking.
    """
    p = PERSONS[variant]
    left = STANDING if phase is None else _walking(phase / GAIT_PHASES)
    right = STANDING if phase is None else _walking(phase / GAIT_PHASES + 0.5)
    shell = join(
        [
            *_trunk(p),
            *_leg(p, left, 1),
            *_leg(p, right, -1),
            *_arm(p, left, 1),
            *_arm(p, right, -1),
        ]
    )
    return shell.placed((0.0, 0.0, -shell.vertices[:, 2].min()))


def stride(variant: int) -> float:
    """Metres of walking per gait cycle."""
    return STRIDE * PERSONS[variant].height
