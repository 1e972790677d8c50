"""Closed shells of triangles: lofts, boxes, ellipsoids, tubes, wheels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from datmo.arrays import F64, Array

SMALLEST = 1e-8  # area below which a triangle is left out [m^2]


@dataclass(frozen=True, eq=False)
class Shell:
    """Triangles (t, 3) over vertices (v, 3) [m], facing outwards, with a reflectivity (t,) each."""

    vertices: F64
    triangles: Array
    reflectivity: F64

    def placed(self, shift: Sequence[float] | F64, R: F64 | None = None) -> Shell:
        """The shell turned by R (3, 3) and then moved by shift (3,) [m]."""
        turned = self.vertices if R is None else np.einsum("ij,vj->vi", R, self.vertices)
        return Shell(turned + np.asarray(shift, float), self.triangles, self.reflectivity)

    def scaled(self, factors: Sequence[float] | F64) -> Shell:
        """The shell stretched along its axes by positive factors (3,)."""
        return Shell(self.vertices * np.asarray(factors, float), self.triangles, self.reflectivity)


def join(shells: Sequence[Shell]) -> Shell:
    """All shells as one, none of them cut."""
    starts = np.cumsum([0, *(len(s.vertices) for s in shells)])
    return Shell(
        np.concatenate([s.vertices for s in shells]),
        np.concatenate([s.triangles + k for s, k in zip(shells, starts[:-1], strict=True)]),
        np.concatenate([s.reflectivity for s in shells]),
    )


def loft(rings: F64, reflectivity: Array | float, cap: float | None = None) -> Shell:
    """A closed shell through m rings of p points, capped at both ends by fans about their middles.

    Args:
        rings: (m, p, 3) [m]. Neighbouring points may coincide: triangles without area are left out.
        reflectivity: one, or (m - 1, p) for the quads from ring to ring.
        cap: of the caps; those of their neighbours by default.
    """
    m, p = rings.shape[:2]
    quad = np.broadcast_to(np.asarray(reflectivity, float), (m - 1, p))
    vertices = np.concatenate([rings.reshape(-1, 3), [rings[0].mean(0), rings[-1].mean(0)]])
    caps = [quad[0], quad[-1]] if cap is None else [np.full(2 * p, cap)]
    shades = np.concatenate([np.repeat(quad.ravel(), 2), *caps])
    return _outward(vertices, _net(m, p), shades)


@cache
def _net(m: int, p: int) -> Array:
    """The triangles of a loft of m rings of p points, and of both caps."""
    here = np.arange(m * p).reshape(m, p)
    near, far = here[:-1], here[1:]
    side = np.roll(near, -1, 1), np.roll(far, -1, 1)
    sides = np.stack([np.stack([near, side[0], side[1]], -1), np.stack([near, side[1], far], -1)], 2)
    first = np.stack([np.full(p, m * p), np.roll(here[0], -1), here[0]], -1)
    last = np.stack([np.full(p, m * p + 1), here[-1], np.roll(here[-1], -1)], -1)
    return np.concatenate([sides.reshape(-1, 3), first, last])


def _cross(a: F64, b: F64) -> F64:
    """a x b, (n, 3); numpy's own spends ten times as long on short lists."""
    (ax, ay, az), (bx, by, bz) = a.T, b.T
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], 1)


def _outward(vertices: F64, triangles: Array, reflectivity: F64) -> Shell:
    """Without slivers, and turned so that the enclosed volume is positive."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    face = _cross(b - a, c - a)
    if np.einsum("ij,ij->", a, face) < 0:
        triangles = triangles[:, ::-1]
    kept = np.sqrt(np.einsum("ij,ij->i", face, face)) / 2 > SMALLEST
    return Shell(vertices, np.ascontiguousarray(triangles[kept]), reflectivity[kept])


def box(center: Sequence[float], size: Sequence[float], reflectivity: float) -> Shell:
    """A cuboid along the axes; center (3,), size (3,) [m]."""
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    rings = np.array([[[x, y, z] for y, z in square] for x in (-0.5, 0.5)])
    return loft(rings * np.asarray(size, float), reflectivity).placed(center)


def ellipsoid(
    center: Sequence[float] | F64, size: Sequence[float], reflectivity: float, sides: int = 12
) -> Shell:
    """An ellipsoid with diameters size (3,) [m]; its poles lie on z."""
    polar = np.linspace(0.02, np.pi - 0.02, sides // 2 + 2)
    turn = 2 * np.pi * np.arange(sides) / sides
    rings = np.stack(
        [
            np.outer(np.sin(polar), np.cos(turn)),
            np.outer(np.sin(polar), np.sin(turn)),
            np.outer(np.cos(polar), np.ones(sides)),
        ],
        -1,
    )
    rings /= np.array([1.0, 1.0, np.cos(0.02)])
    return loft(rings * np.asarray(size, float) / 2, reflectivity).placed(center)


def tube(points: F64, radii: Array, reflectivity: float, sides: int = 10) -> Shell:
    """A round limb through points (m, 3) [m] with radii (m,) or (m, 2) across and along y [m].

    Rings lie across the chord from the first point to the last, so the limb should not bend far.
    """
    points, radii = np.asarray(points, float), np.asarray(radii, float)
    radii = radii if radii.ndim == 2 else np.column_stack([radii, radii])
    axis = points[-1] - points[0]
    axis = axis / np.sqrt(np.einsum("i,i->", axis, axis))
    across = _cross(np.array([[0.0, 1.0, 0.0]]), axis[None])[0]
    across = across / np.sqrt(np.einsum("i,i->", across, across))
    other = _cross(axis[None], across[None])[0]
    turn = 2 * np.pi * np.arange(sides) / sides
    rings = (
        points[:, None]
        + radii[:, :1, None] * np.cos(turn)[:, None] * across
        + radii[:, 1:, None] * np.sin(turn)[:, None] * other
    )
    return loft(rings, reflectivity)


def wheel(
    center: Sequence[float], radius: float, width: float, tyre: float, rim: float, sides: int = 16
) -> Shell:
    """A tyre about the y axis with a sunken bright rim on both sides; center (3,) [m].

    With a multiple of four sides it stands on a flat, `radius` below its middle.
    """
    turn = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    profile = np.array(
        [
            [0.62, -0.42],
            [0.66, -0.5],
            [0.94, -0.5],
            [1.0, -0.38],
            [1.0, 0.38],
            [0.94, 0.5],
            [0.66, 0.5],
            [0.62, 0.42],
        ]
    )
    r = radius / np.cos(np.pi / sides)
    rings = np.stack(
        [
            np.column_stack([r * a * np.cos(turn), np.full(sides, b * width), r * a * np.sin(turn)])
            for a, b in profile
        ]
    )
    shell = loft(rings, tyre)
    radial = np.hypot(*shell.vertices[shell.triangles][..., [0, 2]].mean(1).T)
    shade = np.where(radial < 0.6 * radius, rim, shell.reflectivity)
    return Shell(shell.vertices, shell.triangles, shade).placed(center)


def hoop(
    center: Sequence[float],
    radius: float,
    thickness: float,
    width: float,
    reflectivity: float,
    sides: int = 24,
) -> Shell:
    """A bare tyre about the y axis, of rectangular section; stands as a `wheel` does; center (3,) [m]."""
    turn = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    r = radius / np.cos(np.pi / sides)
    profile = ((r, -width / 2), (r, width / 2), (r - thickness, width / 2), (r - thickness, -width / 2))
    rings = np.stack(
        [np.column_stack([a * np.cos(turn), np.full(sides, b), a * np.sin(turn)]) for a, b in profile]
    )
    here = np.arange(4 * sides).reshape(4, sides)
    far = np.roll(here, -1, 0)
    side, far_side = np.roll(here, -1, 1), np.roll(far, -1, 1)
    quads = np.stack([np.stack([here, side, far_side], -1), np.stack([here, far_side, far], -1)], 2)
    triangles = quads.reshape(-1, 3)
    return _outward(rings.reshape(-1, 3), triangles, np.full(len(triangles), reflectivity)).placed(center)
