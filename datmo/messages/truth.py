"""Truth: what the simulator knows of a scan. It never rides inside Scan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, F64, I32, U8, Bool
from datmo.messages.base import FalseReturn, Kind, Message, Visibility
from datmo.messages.objects import Boxes

HIDDEN_RAYS, HEAVY, PARTIAL = 5, 0.2, 0.8


@dataclass(frozen=True, eq=False)
class LostRays(Message):
    """The rays of a sweep that returned nothing.

    Attributes:
        ring: (m,), column: (m,) which ray; ring 0 is the top.
        actor: (m,) row in `Truth.boxes` of what it met, -1 = no actor.
        thing: (m,) id of the thing it met, -1 = none.
        kind: (m,) `Kind` of what it met, UNKNOWN where it met nothing within range.
        range: (m,) distance to what it met [m], NaN where it met nothing.
    """

    ring: U8
    column: I32
    actor: I32
    thing: I32
    kind: U8
    range: F32

    def __post_init__(self) -> None:
        self._set("ring", (None,), np.uint8)
        m = len(self.ring)
        self._set("column", (m,), np.int32)
        self._set("actor", (m,), np.int32)
        self._set("thing", (m,), np.int32)
        self._set("kind", (m,), np.uint8)
        self._set("range", (m,), np.float32)


@dataclass(frozen=True, eq=False)
class Relief(Message):
    """True ground at the centres of a fixed polar grid, for scoring the ground's height.

    Attributes:
        xy: (g, 2) [m, sensor].
        height: (g,) true z [m, sensor].
        exposed: (g,) whether the sensor would see the place if there were terrain alone.
        kind: (g,) `Kind` of the ground there.
    """

    xy: F64
    height: F64
    exposed: Bool
    kind: U8

    def __post_init__(self) -> None:
        self._set("xy", (None, 2), np.float64)
        g = len(self.xy)
        self._set("height", (g,), np.float64)
        self._set("exposed", (g,), np.bool_)
        self._set("kind", (g,), np.uint8)


@dataclass(frozen=True, eq=False)
class Truth(Message):
    """What one scan truly saw. n returns aligned with `scan.points`, k actors.

    Attributes:
        boxes: k true boxes at `stamp`, id = actor id.
        stamp: [s].
        T_world_actor: (k, 4, 4) at `stamp`; origin on the ground under the box's middle.
        actor: (n,) row in `boxes`, -1 = no actor.
        thing: (n,) id of a static thing, -1 = none.
        kind: (n,) `Kind` of what the ray met.
        is_ground: (n,) the first thing the ray met is terrain.
        height: (n,) true ground [m, sensor], as `Ground.height`, at the measured point.
        normal: (n, 3) of what was hit [unit, sensor].
        solo: (k,) rays that would hit the actor with everything else removed.
        visible: (k,) rays it won. Both before drop-out, the ego's own body counted in neither.
        returns: (k,) after drop-out.
        lost_to: (k, k + 2) rays lost to each actor, to things, to terrain (last two columns).
        visibility: (k,) `Visibility`.
        lost: the rays that returned nothing.
        cause: (n,) `FalseReturn` of a return that lies on no surface (kind `FALSE_RETURN`), else 0.
    """

    boxes: Boxes
    stamp: float
    T_world_actor: F64
    actor: I32
    thing: I32
    kind: U8
    is_ground: Bool
    height: F32
    normal: F32
    solo: I32
    visible: I32
    returns: I32
    lost_to: I32
    visibility: U8
    lost: LostRays
    cause: U8 | None = None

    def __post_init__(self) -> None:
        k = len(self.boxes)
        self._set("actor", (None,), np.int32)
        n = len(self.actor)
        for name, shape, dtype in (
            ("T_world_actor", (k, 4, 4), np.float64),
            ("thing", (n,), np.int32),
            ("kind", (n,), np.uint8),
            ("is_ground", (n,), np.bool_),
            ("height", (n,), np.float32),
            ("normal", (n, 3), np.float32),
            ("solo", (k,), np.int32),
            ("visible", (k,), np.int32),
            ("returns", (k,), np.int32),
            ("lost_to", (k, k + 2), np.int32),
            ("visibility", (k,), np.uint8),
        ):
            self._set(name, shape, dtype)
        self._set("cause", (n,), np.uint8, default=FalseReturn.NONE)


def visibility(solo: I32, visible: I32) -> U8:
    """`Visibility` of each object from its ray counts; the first class that applies."""
    solo, visible = np.asarray(solo), np.asarray(visible)
    fraction = visible / np.maximum(solo, 1)
    classes = [solo < HIDDEN_RAYS, visible < HIDDEN_RAYS, fraction < HEAVY, fraction < PARTIAL]
    return np.select(
        classes,
        [Visibility.OUT_OF_RANGE, Visibility.HIDDEN, Visibility.HEAVY, Visibility.PARTIAL],
        Visibility.VISIBLE,
    ).astype(np.uint8)


def is_any(kind: U8, kinds: tuple[Kind, ...]) -> Bool:
    """(n,) whether each kind is one of `kinds`."""
    return np.isin(kind, np.array(kinds, np.uint8))
