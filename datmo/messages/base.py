"""What every message shares: equality by content and checks at construction."""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any

import numpy as np

from datmo.arrays import Array
from datmo.errors import MessageError


class Kind(IntEnum):
    """What a return or an object is."""

    UNKNOWN = 0
    CAR = 1
    VAN = 2
    TRUCK = 3
    BUS = 4
    MOTORCYCLE = 5
    BICYCLE = 6
    PEDESTRIAN = 7
    ROAD = 8
    SIDEWALK = 9
    FIELD = 10
    VEGETATION = 11
    TRUNK = 12
    BUILDING = 13
    WALL = 14
    POLE = 15
    SIGN = 16
    THING = 17
    FALSE_RETURN = 18


class FalseReturn(IntEnum):
    """What made a return that lies on no surface."""

    NONE = 0
    MIXED_EDGE = 1
    MULTIPATH = 2
    RAIN = 3
    FOG = 4
    SNOW = 5


class Visibility(IntEnum):
    """How much of an object the sensor sees; the first class that applies."""

    OUT_OF_RANGE = 0
    HIDDEN = 1
    HEAVY = 2
    PARTIAL = 3
    VISIBLE = 4


class Status(IntEnum):
    """Track status, Table 4.1: 1-4 initialising, 5 tracking, 6-10 drifting, 0 invalid."""

    INVALID = 0
    INITIALISING = 1
    TRACKING = 5
    DRIFTING = 6
    LAST = 10


VEHICLES = (Kind.CAR, Kind.VAN, Kind.TRUCK, Kind.BUS)
CYCLES = (Kind.MOTORCYCLE, Kind.BICYCLE)
PERSONS = (Kind.PEDESTRIAN,)
GROUNDS = (Kind.ROAD, Kind.SIDEWALK, Kind.FIELD)


def same(a: Any, b: Any) -> bool:
    """Equality by content; NaN equals NaN."""
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        exact = a.dtype == b.dtype and a.shape == b.shape
        return exact and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
    if isinstance(a, float) and isinstance(b, float) and np.isnan(a) and np.isnan(b):
        return True
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b, strict=True))
    return type(a) is type(b) and bool(a == b)


@dataclass(frozen=True, eq=False)
class Message:
    """A frozen struct of arrays, row-aligned, in SI units.

    Fields with `metadata={"compare": False}` (times) do not take part in equality.
    """

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        kept = (f.name for f in fields(self) if f.metadata.get("compare", True))
        return all(same(getattr(self, n), getattr(other, n)) for n in kept)

    __hash__ = None  # type: ignore[assignment]

    def _set(self, name: str, shape: tuple[int | None, ...], dtype: Any, default: Any = None) -> None:
        """Store field `name` as an array of `dtype`, checked against `shape` (None is any length).

        Where the field is None it becomes `default` broadcast to `shape`.
        """
        value = getattr(self, name)
        if value is None:
            value = np.broadcast_to(np.asarray(default, dtype), tuple(s or 0 for s in shape)).copy()
        array = _as_array(f"{type(self).__name__}.{name}", value, dtype)
        fits = array.ndim == len(shape) and all(
            want is None or have == want for have, want in zip(array.shape, shape, strict=True)
        )
        if not fits:
            want = "(" + ", ".join("any" if s is None else str(s) for s in shape) + ")"
            raise MessageError(
                f"{type(self).__name__}.{name} has shape {array.shape}; it must be {want}; "
                "give one row for each row of the first field"
            )
        object.__setattr__(self, name, array)


def _as_array(where: str, value: Any, dtype: Any) -> Array:
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "biuf" and array.size:
            raise TypeError(f"elements of type {array.dtype}")
        return np.ascontiguousarray(array, dtype) if array.ndim else np.asarray(array, dtype)
    except (TypeError, ValueError, OverflowError) as error:
        raise MessageError(f"{where}: {error}; it must be an array of {np.dtype(dtype)}") from None
