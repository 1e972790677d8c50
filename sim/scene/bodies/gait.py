"""How persons move: the joint angles of walking and of running over the gait cycle.

A cycle goes from heel strike (0) of the left foot to its next (1). Walking follows the mean curves of
natural walking: D. A. Winter, Biomechanics and Motor Control of Human Movement, appendix A, and J. Perry,
Gait Analysis; a cycle of two steps covers 0.83 heights at a comfortable speed. Running follows T. F.
Novacheck, "The biomechanics of running", Gait and Posture 7 (1998), figs. 5-7, at a slow 2.8 m/s: toe-off
at 39 % of the cycle, so that twice in a cycle neither foot is on the ground; 160 steps a minute make
1.2 heights a cycle. Toes have no joint here, so the ankle stretches less at toe-off than his. The trunk
leans ahead by 7 degrees, the elbows are held at 90 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from datmo.arrays import F64
from datmo.errors import SimulationError, nearest
from sim.scene.bodies.figure import Pose

GAIT_PHASES = 16
STANDING = Pose(0.0, 0.02, 0.0, 0.02, 0.15)


@dataclass(frozen=True, eq=False)
class Gait:
    """One way of going.

    Attributes:
        stride: metres a cycle over height.
        joints: (cycle) -> hip flexion, knee flexion, toes up [deg], periodic.
        shoulder, elbow: mean and amplitude, forward [deg]; arms swing with the other leg.
        toe_off: share of the cycle at which a foot leaves the ground; below 0.5 the body flies.
        rise: how far it rises above the straight line while it flies, over height.
        lean: of the trunk [rad].
    """

    stride: float
    joints: CubicSpline
    shoulder: tuple[float, float]
    elbow: tuple[float, float]
    toe_off: float = 0.5
    rise: float = 0.0
    lean: float = 0.0

    def pose(self, cycle: float) -> Pose:
        """One side at a share of its cycle."""
        hip, knee, ankle = np.radians(self.joints(cycle % 1.0)).tolist()
        swing = -float(np.cos(2 * np.pi * cycle))
        shoulder, elbow = (
            float(np.radians(mean + size * swing)) for mean, size in (self.shoulder, self.elbow)
        )
        return Pose(hip, knee, ankle, shoulder, elbow)

    def aloft(self, cycle: float) -> float:
        """How far the flight between two steps has gone, 0..1; 0 while a foot stands."""
        step = cycle % 0.5
        return max(step - self.toe_off, 0.0) / (0.5 - self.toe_off) if self.toe_off < 0.5 else 0.0


def _joints(cycle: list[float], hip: list[float], knee: list[float], ankle: list[float]) -> CubicSpline:
    angles: F64 = np.column_stack([hip, knee, ankle])
    return CubicSpline(np.array(cycle), angles, bc_type="periodic")


WALK = Gait(
    stride=0.83,
    joints=_joints(
        [0.0, 0.12, 0.3, 0.5, 0.6, 0.73, 0.87, 1.0],
        hip=[28.0, 24.0, 5.0, -11.0, -3.0, 18.0, 31.0, 28.0],
        knee=[4.0, 18.0, 9.0, 9.0, 35.0, 62.0, 28.0, 4.0],
        ankle=[0.0, -4.0, 8.0, 8.0, -16.0, -3.0, 1.0, 0.0],
    ),
    shoulder=(2.0, 22.0),
    elbow=(22.0, 12.0),
)
RUN = Gait(
    stride=1.2,
    joints=_joints(
        [0.0, 0.1, 0.2, 0.39, 0.5, 0.65, 0.8, 0.92, 1.0],
        hip=[28.0, 28.0, 17.0, -8.0, 3.0, 26.0, 42.0, 37.0, 28.0],
        knee=[12.0, 32.0, 35.0, 30.0, 72.0, 88.0, 64.0, 26.0, 12.0],
        ankle=[2.0, 12.0, 18.0, 6.0, -4.0, 0.0, 4.0, 4.0, 2.0],
    ),
    shoulder=(-8.0, 32.0),
    elbow=(92.0, 10.0),
    toe_off=0.39,
    rise=0.008,
    lean=np.radians(7.0),
)
GAITS = {"walk": WALK, "run": RUN}


def gait(name: str) -> Gait:
    """A gait by its name.

    Raises:
        SimulationError: there is no such gait.
    """
    if name not in GAITS:
        raise SimulationError(f"there is no gait {name!r}; {nearest(name, GAITS)}")
    return GAITS[name]
