"""Social forces: why people on foot change their velocity.

Among people: M. Moussaid, D. Helbing, S. Garnier, A. Johansson, M. Combe, G. Theraulaz, Experimental
study of the behavioural mechanisms underlying self-organization in human crowds, Proc. R. Soc. B 276
(2009) 2755. In groups: M. Moussaid, N. Perozo, S. Garnier, D. Helbing, G. Theraulaz, The walking
behaviour of pedestrian social groups, PLoS ONE 5 (2010) e10047. From borders, here the sides of
vehicles and things: D. Helbing, P. Molnar, Social force model for pedestrian dynamics, Phys. Rev. E
51 (1995) 4282, which caps the speed, too. Forces are per mass, that is accelerations [m/s²].
"""

from __future__ import annotations

import numpy as np

from datmo.arrays import F64, I64
from datmo.geometry import wrap_angle

TAU = 0.54  # relaxation time [s], 2009
A, GAMMA, N, N_PRIME, LAMBDA = 4.5, 0.35, 2.0, 3.0, 2.0
"""Of 2009: strength [m/s²], range [s], how narrow turning and braking are, weight of the velocity."""
BIAS = 0.005  # epsilon of 2009: people prefer one side, here the right
U, R = 10.0, 0.2  # potential [m²/s²] and range [m] of a border, 1995
FASTEST = 1.3  # times the desired speed, 1995
BETA = (4.0, 3.0, 1.0)  # gaze, attraction, repulsion within a group, 2010
FIELD = np.pi / 2  # of vision, to either side [rad], 2010
GLANCE = 0.3  # most that the wish to see the others slows the foremost down [rad]; unbounded in 2010
PASSING, SOFT = 0.3, 0.5  # [m/s], [m]; see avoid and together
CLOSE = 0.8  # members nearer than this keep off each other [m], 2010


def relax(velocity: F64, wish: F64, force: F64, dt: float) -> F64:
    """Velocities (n, 2) after `dt` of dv/dt = (wish - v) / TAU + force, exact while both are constant."""
    final = wish + TAU * force
    return np.asarray(final + (velocity - final) * np.exp(-dt / TAU))


def avoid(position: F64, velocity: F64) -> F64:
    """Force (n, 2) on each of n people from all others, 2009, eq. (3) to (6).

    The force that turns aside fades below the relative speed PASSING, where no one passes the other:
    as published, two who stand side by side would circle each other.

    Args:
        position: (n, 2) [m]. velocity: (n, 2) [m/s].
    """
    apart = position[None] - position[:, None]  # from i to j
    distance = np.hypot(apart[..., 0], apart[..., 1])
    e = apart / np.maximum(distance, 1e-9)[..., None]
    D = LAMBDA * (velocity[:, None] - velocity[None]) + e
    size = np.maximum(np.hypot(D[..., 0], D[..., 1]), 1e-9)
    t = D / size[..., None]
    B = GAMMA * size
    theta = wrap_angle(np.arctan2(e[..., 1], e[..., 0]) - np.arctan2(t[..., 1], t[..., 0])) + B * BIAS
    strength = A * np.exp(-distance / B)
    np.fill_diagonal(strength, 0.0)
    brake = strength * np.exp(-((N_PRIME * B * theta) ** 2))
    moving = np.hypot(*(velocity[:, None] - velocity[None]).transpose(2, 0, 1))
    turn = strength * np.exp(-((N * B * theta) ** 2)) * np.where(theta < 0, -1.0, 1.0)
    turn = turn * np.minimum(moving / PASSING, 1.0)
    left = np.stack([-t[..., 1], t[..., 0]], -1)
    return np.asarray(-(brake[..., None] * t + turn[..., None] * left).sum(1))


def shun(gap: F64) -> F64:
    """Force (n, 2) of borders that are `gap` (n, b, 2) [m] away, from their nearest point to the person."""
    distance = np.maximum(np.hypot(gap[..., 0], gap[..., 1]), 1e-9)
    return np.asarray(((U / R * np.exp(-distance / R) / distance)[..., None] * gap).sum(1))


def together(position: F64, velocity: F64, group: I64) -> F64:
    """Force (n, 2) that keeps the members of a group (n,) together and abreast, 2010.

    Attraction and repulsion set in over the length SOFT, not at once, so that who stands does not tremble.
    """
    force = np.zeros_like(position)
    for name in np.unique(group):
        rows = np.flatnonzero(group == name)
        if len(rows) > 1:
            force[rows] = _cohesion(position[rows], velocity[rows])
    return force


def _cohesion(x: F64, v: F64) -> F64:
    gaze, attraction, repulsion = BETA
    n = len(x)
    to_centre = x.mean(0) - x
    far = np.hypot(to_centre[:, 0], to_centre[:, 1])
    inward = to_centre / np.maximum(far, 1e-9)[:, None]
    speed = np.hypot(v[:, 0], v[:, 1])
    cosine = (inward * v).sum(1) / np.maximum(speed, 1e-9)
    turn = np.where((speed > 0.1) & (far > 1e-6), np.arccos(np.clip(cosine, -1, 1)) - FIELD, 0.0)
    force = -gaze * np.clip(turn, 0.0, GLANCE)[:, None] * v
    force = force + attraction * np.clip((far - (n - 1) / 2) / SOFT, 0.0, 1.0)[:, None] * inward
    apart = x[:, None] - x[None]
    distance = np.hypot(apart[..., 0], apart[..., 1])
    push = repulsion * np.clip((CLOSE - distance) / SOFT, 0.0, 1.0) / np.maximum(distance, 1e-9)
    return np.asarray(force + (apart * push[..., None]).sum(1))
