"""Persons who sit: their feet and hands are put where the vehicle wants them, knees and elbows follow.

Two segments of lengths a and b reach a point at distance d with an angle of (a² + d² - b²) / (2 a d) in its
cosine at the first joint (law of cosines).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F64
from sim.scene.bodies.figure import (
    FOREARM,
    HAND,
    NECK,
    SHANK,
    SHOULDER,
    THIGH,
    UPPER_ARM,
    Person,
    Pose,
    arm_through,
    head,
    leg,
    pitched,
    trunk,
)
from sim.scene.bodies.primitives import Shell, ellipsoid, join

STRAIGHTEST = 0.995  # of a limb's length
OUTWARD = 0.5  # of an elbow, for one downwards


@dataclass(frozen=True)
class Seat:
    """Where a rider sits [m, vehicle frame], the left side given; the right is its mirror image.

    Attributes:
        hip: (x, z) of the hip joints. lean: of the trunk ahead [rad]. nod: of the head ahead [rad].
        grip: (x, y, z) of the left hand. feet: (x, y, z) of the left and the right ankle, y > 0 for both.
        toes: of the foot, upwards [rad].
    """

    hip: tuple[float, float]
    lean: float
    nod: float
    grip: tuple[float, float, float]
    feet: tuple[tuple[float, float, float], tuple[float, float, float]]
    toes: float


def reach(a: float, b: float, d: float) -> tuple[float, float, float]:
    """Angles at the first and at the middle joint (0 straight) [rad], and d no longer than they reach."""
    d = float(np.clip(d, abs(a - b) + 1e-3, STRAIGHTEST * (a + b)))
    first = np.arccos((a * a + d * d - b * b) / (2 * a * d))
    middle = np.pi - np.arccos((a * a + b * b - d * d) / (2 * a * b))
    return float(first), float(middle), d


def _leg(p: Person, seat: Seat, side: int) -> Shell:
    """A leg from the hip to its foot, splayed so that the foot is as far out as it should be."""
    x, y, z = seat.feet[0 if side > 0 else 1]
    h = p.scale
    dx, dz = x - seat.hip[0], z - seat.hip[1]
    out = y - 0.052 * h * p.girth
    down = float(np.hypot(dz, out))
    first, knee, _ = reach(THIGH * h, SHANK * h, float(np.hypot(dx, down)))
    hip = float(np.arctan2(dx, down)) + first
    pose = Pose(hip, knee, seat.toes - hip + knee, 0.0, 0.0)
    splay = side * float(np.arctan2(out, -dz))
    c, s = np.cos(splay), np.sin(splay)
    R = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    joint = np.array([0.0, side * 0.052 * h * p.girth, 0.0])
    made = leg(p, pose, side).placed(-joint, None).placed(joint, R)
    return made.placed((seat.hip[0], 0.0, seat.hip[1]))


def _arm(p: Person, seat: Seat, side: int) -> Shell:
    """An arm from the leaning shoulder to the grip, the elbow down and outwards."""
    h = p.scale
    at = np.array([0.0, side * SHOULDER[0] * h * p.girth, SHOULDER[1] * h])
    shoulder = _bowed(at, seat.lean) + np.array([seat.hip[0], 0.0, seat.hip[1]])
    grip = np.array([seat.grip[0], side * seat.grip[1], seat.grip[2]])
    along = grip - shoulder
    d = float(np.sqrt(np.einsum("i,i->", along, along)))
    along = along / d
    first, _, d = reach(UPPER_ARM * h, FOREARM * h, d - 0.3 * HAND * h)
    down = np.array([0.0, side * OUTWARD, -1.0])
    down = down - np.einsum("i,i->", down, along) * along
    down = down / np.sqrt(np.einsum("i,i->", down, down))
    elbow = shoulder + UPPER_ARM * h * (np.cos(first) * along + np.sin(first) * down)
    wrist = shoulder + d * along
    tip = wrist + 0.7 * HAND * h * along
    return arm_through(p, shoulder, elbow, wrist, tip)


def _bowed(point: F64, lean: float) -> F64:
    return np.asarray(np.einsum("ij,j->i", pitched(-lean), point))


def rider(p: Person, seat: Seat, helmet: float = 0.0) -> Shell:
    """The whole rider [m, vehicle frame]; with a closed helmet of that reflectivity if it is not 0."""
    hip = np.array([seat.hip[0], 0.0, seat.hip[1]])
    neck = np.array([0.0, 0.0, NECK * p.scale])
    top = [head(p)]
    if helmet:
        k = p.scale
        top.append(ellipsoid((0.008 * k, 0, 0.41 * k), (0.15 * k, 0.13 * k, 0.145 * k), helmet))
    return join(
        [
            trunk(p).placed(hip, pitched(-seat.lean)),
            join(top).placed(-neck).placed(hip + _bowed(neck, seat.lean), pitched(-seat.nod)),
            *(part(p, seat, side) for side in (1, -1) for part in (_leg, _arm)),
        ]
    )
