"""New tracks: a Cartesian Kalman filter until five hits confirm them (method.md section 13).

Heading and turn are not yet observable, so position and velocity alone are filtered.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from scipy.optimize import linear_sum_assignment

from datmo.arrays import F64, I64, Array, Bool
from datmo.geometry import half_turn, wrap_angle
from datmo.messages import Boxes
from datmo.tracks.association.gate import determinant, squared_distance
from datmo.tracks.config import TrackerConfig
from datmo.tracks.filters.ukf import inverse_2x2
from datmo.tracks.measurement.box import yaw_is_sure
from datmo.tracks.measurement.ends import anchor, moved_middle
from datmo.tracks.measurement.measured import Measured
from datmo.tracks.measurement.trust import evidence

H = np.eye(2, 4)
NEW_YAW_RATE_STD = 0.3  # [rad/s] of a track just confirmed
UNSURE_YAW_STD = 0.8  # [rad] where neither motion nor the box tells the heading
TELLING_SPEED = 1.5  # [m/s] from which motion tells the heading


@dataclass
class Newborns:
    """Tracks of status 1-4, n rows: x (n, 4) px, py, vx, vy; hits and misses; the last box.

    `held` (n, 2) is the end that was last the only real one, by side of the box. `evidence` is -log of the
    probability that none of its boxes so far is real, `mass` the sum of their weights, one over their noise
    squared.
    """

    id: I64
    born: F64
    x: F64
    P: F64
    hits: I64
    misses: I64
    size: F64
    yaw: F64
    sure: Bool
    held: F64
    z: F64
    score: F64
    kind: I64
    evidence: F64
    mass: F64

    def __len__(self) -> int:
        return len(self.id)

    @classmethod
    def start(cls, ids: I64, stamp: float, given: Measured, config: TrackerConfig) -> Newborns:
        """One track for each box, at rest with a wide prior."""
        n, boxes, factor = len(given), given.boxes, given.factor
        x, P = np.column_stack([boxes.center[:, :2], np.zeros((n, 2))]), np.zeros((n, 4, 4))
        P[:, [0, 1], [0, 1]] = ((config.position_std * factor) ** 2)[:, None]
        P[:, [2, 3], [2, 3]] = config.birth_speed_std**2
        return cls(
            ids, np.full(n, stamp), x, P, np.ones(n, np.int64), np.zeros(n, np.int64),
            boxes.size.copy(), boxes.yaw.copy(), yaw_is_sure(boxes.size, config), np.zeros((n, 2)),
            boxes.center[:, 2].copy(), boxes.score.astype(float), boxes.kind.astype(np.int64),
            evidence(given.trust), factor**-2,
        )  # fmt: skip

    def select(self, rows: Array) -> Newborns:
        """A copy of `rows`."""
        return Newborns(*(getattr(self, f.name)[rows].copy() for f in fields(self)))

    def join(self, other: Newborns) -> Newborns:
        """These and then the others."""
        pairs = ((getattr(self, f.name), getattr(other, f.name)) for f in fields(self))
        return Newborns(*(np.concatenate(pair) for pair in pairs))

    def predict(self, dt: float, config: TrackerConfig) -> None:
        """Constant velocity with white acceleration."""
        F, q = np.eye(4), 2 * config.accel_density
        F[0, 2] = F[1, 3] = dt
        Q = q * np.kron([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]], np.eye(2))
        self.x = np.einsum("ij,nj->ni", F, self.x)
        self.P = np.einsum("ij,njk,lk->nil", F, self.P, F) + Q

    def match(self, given: Measured, config: TrackerConfig) -> tuple[I64, I64]:
        """Rows (newborn, box) of the cheapest assignment within the gate."""
        boxes, R = given.boxes, (config.position_std * given.factor) ** 2
        S = self.P[:, None, :2, :2] + R[None, :, None, None] * np.eye(2)
        nu = boxes.center[None, :, :2] - self.x[:, None, :2]
        d = squared_distance(nu, S)
        cost = d + np.log(determinant(S))
        fits = (d <= config.gate_chi2) & _alike(self.size, boxes.size)
        cost = np.where(fits, cost, 1e6)
        rows, columns = linear_sum_assignment(cost)
        kept = fits[rows, columns]
        return rows[kept], columns[kept]

    def correct(self, rows: I64, given: Measured, real: Bool | None, config: TrackerConfig) -> None:
        """Take boxes, one for each of `rows`.

        real: (k, 2, 2) ends of the boxes that rays show to be real; as these stay, the middle moves with the
        size, which grows. None: the boxes are whole, their sizes averaged.
        """
        boxes, factor = given.boxes, given.factor
        place = boxes.center[:, :2] if real is None else self._anchored(rows, boxes, real)
        P = self.P[rows]
        S = P[:, :2, :2] + ((config.position_std * factor) ** 2)[:, None, None] * np.eye(2)
        K = np.einsum("nij,njk->nik", P[:, :, :2], inverse_2x2(S))
        self.x[rows] += np.einsum("nij,nj->ni", K, place - self.x[rows, :2])
        self.P[rows] = P - np.einsum("nij,njk,nlk->nil", K, S, K)
        self.hits[rows] += 1
        self.evidence[rows] += evidence(given.trust)
        self.mass[rows] += factor**-2
        sure = yaw_is_sure(boxes.size, config)
        take = sure | ~self.sure[rows]
        self.yaw[rows] = np.where(take, boxes.yaw, self.yaw[rows])
        self.sure[rows] |= sure
        size, share = self.size[rows], (factor**-2 / self.mass[rows])[:, None]
        mean, largest = size + share * (boxes.size - size), np.maximum(size, boxes.size)
        self.size[rows] = mean if real is None else largest
        self.z[rows] = boxes.center[:, 2]
        self.score[rows], self.kind[rows] = boxes.score, boxes.kind

    def _anchored(self, rows: I64, boxes: Boxes, real: Bool) -> F64:
        """Places (k, 2) of the boxes as those of the sizes so far, to which the states move first."""
        more = boxes.size[:, :2] - self.size[rows, :2]
        across = np.abs(half_turn(boxes.yaw - self.yaw[rows])) > np.pi / 4
        held = np.where(across[:, None], 0.0, anchor(real))
        self.held[rows] = np.where(held == 0, self.held[rows], held)
        self.x[rows, :2] += moved_middle(held, np.maximum(more, 0), boxes.yaw)
        return boxes.center[:, :2] + moved_middle(held, np.maximum(-more, 0), boxes.yaw)

    def ripe(self, config: TrackerConfig) -> Bool:
        """(n,) whether each is to be confirmed: by enough hits, or sooner by boxes that are surely real."""
        enough = -np.log(max(1 - config.confirm_trust, 1e-300))
        return np.asarray((self.hits >= config.confirm_hits) | (self.evidence >= enough))

    def polar(self, config: TrackerConfig) -> tuple[F64, F64, F64]:
        """State (n, 5), covariance (n, 5, 5) over (x, y, yaw, speed, yaw rate), box heading (n,).

        The motion tells the heading when it is fast and certain; the box tells it else, if sure.
        A sure box overrules a motion that is within 30 degrees of its line.
        """
        v = self.x[:, 2:]
        speed = np.linalg.norm(v, axis=1)
        spread = np.sqrt(np.maximum(np.einsum("nii->n", self.P[:, 2:, 2:]) / 2, 0))
        told = speed > np.maximum(TELLING_SPEED, 3 * spread)
        course = np.arctan2(v[:, 1], v[:, 0])
        off = half_turn(self.yaw - course)
        by_box = self.sure & (~told | (np.abs(off) < np.pi / 6))
        near_course = wrap_angle(course + off)
        psi = np.where(by_box, np.where(speed > 0.3, near_course, self.yaw), np.where(told, course, self.yaw))
        heading = np.column_stack([np.cos(psi), np.sin(psi)])
        along = np.einsum("ni,ni->n", v, heading)
        x = np.column_stack([self.x[:, :2], wrap_angle(psi), along, np.zeros(len(self))])
        return x, self._polar_cov(heading, by_box, told, speed, config), near_course

    def _polar_cov(self, heading: F64, by_box: Bool, told: Bool, speed: F64, config: TrackerConfig) -> F64:
        n, safe = len(self), np.maximum(speed, TELLING_SPEED)
        normal = np.column_stack([-heading[:, 1], heading[:, 0]]) / safe[:, None]
        J = np.zeros((n, 5, 4))
        J[:, 0, 0] = J[:, 1, 1] = 1
        J[:, 2, 2:] = np.where((told & ~by_box)[:, None], normal, 0)
        J[:, 3, 2:] = heading
        P = np.einsum("nij,njk,nlk->nil", J, self.P, J)
        unsure = np.where(told, 0.0, UNSURE_YAW_STD**2)
        P[:, 2, 2] += np.where(by_box, config.yaw_std**2, unsure) + 1e-4
        P[:, 4, 4] += NEW_YAW_RATE_STD**2
        return np.asarray(P + 1e-9 * np.eye(5))


def _alike(a: F64, b: F64) -> Bool:
    """(n, m) whether two sizes may be of one object: neither is over three times the other."""
    la, lb = a[:, None, 0] + a[:, None, 1] + 0.5, b[None, :, 0] + b[None, :, 1] + 0.5
    return np.asarray((la < 3 * lb) & (lb < 3 * la))
