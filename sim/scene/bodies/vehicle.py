"""Cars, vans and trucks: a body lofted through cross-sections, wheels in their arches, plates, lamps.

A body is described by curves over s, the distance from the front bumper [m]. At each station the half
section runs, from below: floor, up the inside of the wheel arch, out to the sill, flank, belt line,
edge of roof or bonnet, crown. Lamps lie between flank and belt, side windows between belt and edge,
screens between edge and edge over the top.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from datmo.arrays import F64, Array
from sim.scene.bodies import materials as m
from sim.scene.bodies.primitives import Shell, box, join, loft, wheel
from sim.scene.bodies.variety import Variety

Curve = tuple[tuple[float, float], ...]  # (s [m], value)
Spans = tuple[tuple[float, float], ...]  # from s to s [m]
Span = tuple[float, float]
LAMP_ROWS, GLASS_ROWS, ROOF_ROWS = np.array([3, 9]), np.array([4, 8]), np.array([5, 6, 7])
ARCH = (-1.0, -0.995, -0.92, -0.7, -0.38, 0.0, 0.38, 0.7, 0.92, 0.995, 1.0)
INSET = 0.008  # the bumpers lie behind the plates, which end the vehicle [m]


@dataclass(frozen=True)
class Body:
    """Measures of a vehicle [m].

    `top` and `belt` are heights over s, `windows` intervals of s that are glazed at the sides, `screens`
    those glazed above. `roof` is half the roof's width over half the body's, `sides` a curve of
    the body's width over its greatest.
    """

    length: float
    width: float
    floor: float
    axles: tuple[float, ...]
    wheel_radius: float
    wheel_width: float
    top: Curve
    belt: Curve
    roof: Curve
    sides: Curve
    windows: Spans
    screens: Spans


@dataclass(frozen=True)
class Car:
    """A body and what is put on it.

    Attributes:
        paint: its reflectivity. plate: height of the number plates [m].
        mirror: (s, height) [m].
        walls: of an open bed, each from s to s [m], from y to y over half the width, from z to z [m].
    """

    body: Body
    paint: float
    plate: float
    mirror: tuple[float, float]
    walls: tuple[tuple[Span, Span, Span], ...] = ()


def _at(curve: Curve, s: Array) -> F64:
    return np.interp(s, [a for a, _ in curve], [b for _, b in curve])


def _inside(spans: Sequence[tuple[float, float]], s: F64) -> Array:
    return np.array([any(a <= x <= b for a, b in spans) for x in s])


def _stations(body: Body) -> F64:
    """All s at which something bends, the arches finely; none nearer to another than a millimetre."""
    reach = body.wheel_radius * 1.2
    s = [a for curve in (body.top, body.belt, body.roof, body.sides) for a, _ in curve]
    s += [a for span in body.windows + body.screens for a in span]
    s += [axle + reach * a for axle in body.axles for a in ARCH]
    s += [0.2, body.length - 0.12]  # lamps
    unique = np.unique(np.round([a for a in s if 0 <= a <= body.length], 3))
    return np.asarray(unique)


def _arch(body: Body, s: F64) -> F64:
    """Height of the sill's lower edge: the floor, or the round of a wheel arch."""
    reach = body.wheel_radius * 1.2
    lip = np.full(len(s), body.floor)
    for axle in body.axles:
        under = reach**2 - (s - axle) ** 2
        lip = np.maximum(lip, np.where(under > 0, body.wheel_radius + np.sqrt(np.maximum(under, 0)), 0))
    return lip


def hull(body: Body, paint: float) -> Shell:
    """The painted and glazed body without wheels, front at x = length / 2."""
    s = _stations(body)
    top, lip = _at(body.top, s), _arch(body, s)
    belt = np.minimum(_at(body.belt, s), top - 0.03)
    half = body.width / 2 * _at(body.sides, s)
    edge = half * _at(body.roof, s)
    inner = np.minimum(body.width / 2 - body.wheel_width - 0.06, half * 0.9)
    lip = np.minimum(lip, belt - 0.06)
    flank = np.maximum(body.floor + 0.5 * (belt - body.floor), lip + 0.03)
    y = np.stack([inner, inner, half * 0.96, half, half * 0.97, edge, edge * 0.55], 1)
    z = np.stack([np.full(len(s), body.floor), lip, lip, flank, belt, top - 0.03, top], 1)
    y, z = np.concatenate([y, -y[:, ::-1]], 1), np.concatenate([z, z[:, ::-1]], 1)
    x = np.broadcast_to((body.length / 2 - np.clip(s, INSET, body.length - INSET))[:, None], y.shape)
    middle = (s[1:] + s[:-1]) / 2
    shade = np.full((len(s) - 1, y.shape[1]), paint)
    shade[:, [0, 13]] = m.UNDERBODY
    shade[np.ix_(_inside(body.windows, middle), GLASS_ROWS)] = m.GLASS
    shade[np.ix_(_inside(body.screens, middle), ROOF_ROWS)] = m.GLASS
    shade[np.ix_((middle < 0.2) | (middle > body.length - 0.12), LAMP_ROWS)] = m.LAMP
    return loft(np.stack([x, y, z], -1), shade, paint)


def wheels(body: Body) -> list[Shell]:
    """A pair of wheels at each axle, flush with the flanks."""
    out = body.width / 2 - body.wheel_width / 2 - 0.02
    return [
        wheel(
            (body.length / 2 - s, j * out, body.wheel_radius),
            body.wheel_radius,
            body.wheel_width,
            m.TYRE,
            m.RIM,
        )
        for s in body.axles
        for j in (1, -1)
    ]


def plates(body: Body, height: float) -> list[Shell]:
    """Number plates (520 x 110 mm) on the bumpers, the foremost and the hindmost parts."""
    x = body.length / 2 - 0.01
    return [box((end * x, 0, height), (0.02, 0.52, 0.11), m.PLATE) for end in (1, -1)]


def mirrors(body: Body, s: float, height: float) -> list[Shell]:
    """Wing mirrors that end where the body is widest."""
    y = body.width / 2 - 0.09
    return [box((body.length / 2 - s, j * y, height), (0.12, 0.18, 0.14), m.TRIM) for j in (1, -1)]


def walls(car: Car) -> list[Shell]:
    """The walls of an open bed, if there is one."""
    half, front = car.body.width / 2, car.body.length / 2
    return [
        box(
            (front - (s0 + s1) / 2, half * (y0 + y1) / 2, (z0 + z1) / 2),
            (s1 - s0, half * (y1 - y0), z1 - z0),
            car.paint,
        )
        for (s0, s1), (y0, y1), (z0, z1) in car.walls
    ]


def varied(car: Car, variety: Variety, widest: float = np.inf) -> Car:
    """Another car of the same class: bonnet, wheelbase, overhangs, width, height, wheels, paint.

    Cars of one class differ by so much: lengths of compact hatchbacks run from 4.05 to 4.38 m, widths from
    1.75 to 1.83 m, heights from 1.43 to 1.50 m (Polo, Golf, Astra, Focus; makers' data). None is wider than
    `widest` [m].
    """
    b = car.body
    front, rear = b.axles[0], b.axles[-1]
    middle = (front + rear) / 2
    old = np.array([0.0, front, middle, rear, b.length])
    overhang = variety.about(front, 0.05) - front, variety.about(b.length - rear, 0.06) - (b.length - rear)
    half = (variety.about(rear - front, 0.04) - (rear - front)) / 2
    grown = np.cumsum([0.0, overhang[0], half, half, overhang[1]])
    grown[2] += variety.about(middle, 0.015) - middle  # the bonnet against the cabin
    tall = variety.about(1.0, 0.03)

    def along(s: float) -> float:
        return s + float(np.interp(s, old, grown))

    def spans(given: Spans) -> Spans:
        return tuple((along(a), along(c)) for a, c in given)

    def curve(given: Curve, factor: float = 1.0) -> Curve:
        return tuple((along(s), value * factor) for s, value in given)

    body = replace(
        b, length=along(b.length), width=min(variety.about(b.width, 0.02), widest),
        axles=tuple(map(along, b.axles)),
        wheel_radius=variety.about(b.wheel_radius, 0.03), top=curve(b.top, tall), belt=curve(b.belt, tall),
        roof=curve(b.roof), sides=curve(b.sides), windows=spans(b.windows), screens=spans(b.screens),
    )  # fmt: skip
    moved = tuple((spans((s,))[0], y, (z[0] * tall, z[1] * tall)) for s, y, z in car.walls)
    paint = variety.about(variety.pick(car.paint, m.PAINT), 0.1)
    mirror = along(car.mirror[0]), car.mirror[1] * tall
    return replace(car, body=body, paint=paint, mirror=mirror, walls=moved)


def assembled(car: Car) -> Shell:
    """The whole car or van."""
    body = car.body
    return join(
        [
            hull(body, car.paint),
            *wheels(body),
            *plates(body, car.plate),
            *mirrors(body, *car.mirror),
            *walls(car),
        ]
    )
