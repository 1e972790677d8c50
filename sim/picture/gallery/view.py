"""A mesh in perspective: shaded, on a plain floor that takes its shadow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from datmo.arrays import F32, F64, I32, U8, Bool
from datmo.messages import Kind
from sim.picture.palette import KIND
from sim.scan.embree import MISS, Mesh

FLOOR, BACK = (228, 231, 235), (214, 226, 236)
LIGHT = np.array([0.35, 0.55, 0.85])
AMBIENT, BRIGHT = 0.55, 1.25
FINER = 3  # rays a pixel along each side
LIFT = 4e-3  # of what looks for the light, off its surface [m]


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole.

    Attributes:
        eye: (3,) [m]. axes: (3, 3) rows right, up, forward. scale: of a pixel at 1 m. shape: h, w.
    """

    eye: F64
    axes: F64
    scale: float
    shape: tuple[int, int]

    def directions(self, astray: float = 0.0) -> F64:
        """Unit vectors (h w, 3) through the pixels' middles, row by row from the top.

        Args:
            astray: at most so far from the middle, by chance [pixels]; fine patterns would else swim.
        """
        h, w = self.shape
        right, up, forward = self.axes
        off = np.random.default_rng(0).uniform(-astray, astray, (2, h, w))
        across = (np.arange(w) + 0.5 - w / 2 + off[0]) * self.scale
        down = (np.arange(h)[:, None] + 0.5 - h / 2 + off[1]) * self.scale
        ray = forward + across[..., None] * right - down[..., None] * up
        return np.asarray(ray / np.sqrt(np.sum(ray**2, -1))[..., None]).reshape(-1, 3)

    def pixels(self, points: F64) -> tuple[F64, F64]:
        """Column and row (n, 2) of points (n, 3), and their depth (n,) [m]."""
        seen = np.einsum("ij,nj->ni", self.axes, points - self.eye)
        h, w = self.shape
        depth = np.maximum(seen[:, 2], 1e-6)
        across = seen[:, :2] / depth[:, None] / self.scale
        return np.column_stack([across[:, 0] + w / 2, h / 2 - across[:, 1]]), depth


def camera(low: F64, high: F64, shape: tuple[int, int], azimuth_deg: float, rise_deg: float = 14.0) -> Camera:
    """A camera that sees the box low..high (3,) filling the picture, from an azimuth and so far up."""
    a, e = np.deg2rad([azimuth_deg, rise_deg])
    forward = -np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    axes = np.stack([right, np.cross(right, forward), forward])
    corners = np.array(
        [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    )
    middle = (low + high) / 2
    seen = np.abs(np.einsum("ij,nj->ni", axes, corners - middle))
    scale = 0.36 / min(shape)
    room = scale * np.array([shape[1], shape[0]]) / 2 * 0.9
    away = float((seen[:, :2] / room).max() + seen[:, 2].max())
    return Camera(middle - away * forward, axes, scale, shape)


def looking(eye: F64, target: F64, fov_deg: float, shape: tuple[int, int]) -> Camera:
    """A camera at `eye` (3,) that looks at `target` (3,), so wide from left to right."""
    forward = (target - eye) / np.sqrt(np.sum((target - eye) ** 2))
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.sqrt(np.sum(right**2))
    axes = np.stack([right, np.cross(right, forward), forward])
    return Camera(eye, axes, 2 * float(np.tan(np.deg2rad(fov_deg) / 2)) / shape[1], shape)


def colours(kind: U8, reflectivity: F32) -> F64:
    """Colours (t, 3) of triangles: their kind's, lighter where they reflect more."""
    table = np.zeros((len(Kind), 3))
    for code, colour in KIND.items():
        table[code] = colour
    bright: F64 = 0.35 + 0.95 * np.sqrt(reflectivity.astype(float))
    return np.asarray(table[kind] * bright[:, None])


def mesh_view(vertices: F32, triangles: I32, colour: F64, view: Camera, level: float = 0.0) -> U8:
    """The mesh (v, 3), (t, 3) with colours (t, 3) in the sun, on a floor z = level: a picture (h, w, 3)."""
    h, w = view.shape
    fine = Camera(view.eye, view.axes, view.scale / FINER, (h * FINER, w * FINER))
    d, mesh = fine.directions(0.5), Mesh(vertices, triangles)
    light = LIGHT / np.sqrt(np.sum(LIGHT**2))
    hits = mesh.cast(_many(view.eye, len(d)), d.astype(np.float32))
    floor = np.where(d[:, 2] < 0, (level - view.eye[2]) / np.minimum(d[:, 2], -1e-9), np.inf)
    reach = np.where(hits.triangle >= 0, hits.distance.astype(float), np.inf)
    on = (reach < floor + LIFT) & (hits.triangle >= 0)
    met = np.flatnonzero(on | np.isfinite(floor))
    on, reach = on[met], np.minimum(reach, floor)[met]
    normal = np.where(on[:, None], hits.normal[met].astype(float), [0.0, 0.0, 1.0])
    normal /= np.sqrt(np.sum(normal**2, 1))[:, None]
    normal *= -np.sign(np.sum(normal * d[met], 1))[:, None]
    place = view.eye + reach[:, None] * d[met] + LIFT * normal
    sunny = mesh.cast(place.astype(np.float32), _many(light, len(met))).distance >= MISS
    facing = np.clip(np.sum(normal * light, 1), 0, 1) * sunny
    base = np.where(on[:, None], colour[hits.triangle[met]], FLOOR)
    image = np.empty((len(d), 3))
    image[:] = BACK
    image[met] = base * (AMBIENT + (1 - AMBIENT) * np.minimum(facing * BRIGHT, 1.0))[:, None]
    coarse = image.reshape(h, FINER, w, FINER, 3).mean((1, 3))
    return np.asarray(np.clip(coarse, 0, 255), np.uint8)


def splat(view: Camera, points: F64, colour: F64, background: tuple[int, int, int]) -> U8:
    """Points (n, 3) as dots of their colours (n, 3), the nearer over the farther, as a picture (h, w, 3)."""
    h, w = view.shape
    image = np.empty((h, w, 3), np.uint8)
    image[:] = background
    at, depth = view.pixels(points)
    order = np.argsort(-depth, kind="stable")
    column, row = np.floor(at[order]).astype(int).T
    shade = np.clip(colour[order], 0, 255).astype(np.uint8)
    for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
        x, y = column + dx, row + dy
        inside: Bool = (x >= 0) & (x < w) & (y >= 0) & (y < h)
        image[y[inside], x[inside]] = shade[inside]
    return image


def _many(vector: F64, n: int) -> F32:
    return np.ascontiguousarray(np.broadcast_to(vector, (n, 3)), np.float32)
