"""The tracks that are alive, as a struct of arrays, row-aligned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from datmo.arrays import F64, I64, Array, Bool

HISTORY = 64


@dataclass
class Bank:
    """Confirmed tracks. t rows, m modes.

    Attributes:
        id: (t,) never used twice. born, seen: (t,) stamp of the first and the last hit [s].
        steady: (t,) stamp since when hits have followed each other closely [s].
        fresh: (t,) whether the last scan hit it.
        x: (t, m, n), P: (t, m, n, n), mu: (t, m) of each mode.
        missed: (t,) time without a hit where it should have been seen [s].
        existence: (t,) probability that there is such an object; 1 unless "jipda" is asked for.
        known: (t, 2) whether both ends of the length, and of the width, were ever seen to be real.
        held: (t, 2) by side: the end that was last the only real one, 1 front, -1 back, 0 never.
        size: (t, 3) retained dimensions [m]. yaw: (t,) heading of the box [rad].
        z: (t,) height of the box's middle [m], climb: (t,) its rate [m/s].
        score: (t,), kind: (t,) of the last box.
        dynamic: (t,) bool. backward: (t,) time spent going backwards [s].
        past: (t, HISTORY, 4) stamp, x, y, speed of the last scans, newest last, NaN before.
    """

    id: I64
    born: F64
    seen: F64
    steady: F64
    fresh: Bool
    x: F64
    P: F64
    mu: F64
    missed: F64
    existence: F64
    known: Bool
    held: F64
    size: F64
    yaw: F64
    z: F64
    climb: F64
    score: F64
    kind: I64
    dynamic: Bool
    backward: F64
    past: F64

    def __len__(self) -> int:
        return len(self.id)

    @classmethod
    def empty(cls, modes: int, size: int) -> Bank:
        """No tracks of `modes` modes and states of `size` coordinates."""
        real, whole = np.zeros(0), np.zeros(0, np.int64)
        x, P, mu = np.zeros((0, modes, size)), np.zeros((0, modes, size, size)), np.zeros((0, modes))
        flag, past = np.zeros(0, np.bool_), np.zeros((0, HISTORY, 4))
        return cls(
            whole, real, real, real, flag, x, P, mu, real, real,
            np.zeros((0, 2), np.bool_), np.zeros((0, 2)), np.zeros((0, 3)),
            real, real, real, real, whole, flag, real, past,
        )  # fmt: skip

    def select(self, rows: Array | slice) -> Bank:
        """A copy of `rows` (indices, a mask, a slice)."""
        return self._map(lambda a: a[rows].copy())

    def join(self, other: Bank) -> Bank:
        """These tracks and then the others."""
        pairs = ((getattr(self, f.name), getattr(other, f.name)) for f in fields(self))
        return Bank(*(np.concatenate(pair) for pair in pairs))

    def split(self, count: int) -> tuple[Bank, Bank]:
        """The first `count` tracks and the rest, the inverse of `join`."""
        return self.select(slice(count)), self.select(slice(count, None))

    def mark(self, hit: Bool, stamp: float, broken: float) -> None:
        """Note which tracks `stamp` [s] hit (t,); after more than `broken` [s] hits begin to count anew."""
        self.steady = np.where(hit & (stamp - self.seen > broken), stamp, self.steady)
        self.fresh, self.seen = hit, np.where(hit, stamp, self.seen)

    def shift(self, by: F64) -> None:
        """Move the places of all modes, and those of the past, by (t, 2) [m, world]."""
        self.x[:, :, :2] += by[:, None]
        self.past[:, :, 1:3] += by[:, None]

    def remember(self, stamp: float, mean: F64) -> None:
        """Append the state (t, n) at `stamp` to the past."""
        self.past[:, :-1] = self.past[:, 1:]
        self.past[:, -1, 0] = stamp
        self.past[:, -1, 1:] = mean[:, [0, 1, 3]]

    def _map(self, change: Callable[[Array], Array]) -> Bank:
        return Bank(*(change(getattr(self, f.name)) for f in fields(self)))
