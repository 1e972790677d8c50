"""Small analytic scenes with known truth: HDL-64-like rays against a height field and boxes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numba
import numpy as np
import pytest

from datmo.arrays import F64, I32, Array, Bool

CELL, HALF, HEIGHT = 0.25, 90.0, 1.73
ROUGHNESS = {
    "flat": 0.0,
    "A": 0.0038,
    "B": 0.0076,
    "C": 0.015,
    "D": 0.030,
    "E": 0.061,
    "F": 0.122,
    "G": 0.244,
}


@dataclass(frozen=True)
class Scene:
    """points (n, 3) [m, sensor], truth aligned with them; object -1 is terrain; relief from above."""

    points: Array
    ring: Array
    is_ground: Bool
    height: F64
    object: I32
    relief: F64

    def true_height(self, xy: F64) -> F64:
        """Height (n,) of the terrain [m, sensor]."""
        foot = height_at(self.relief, 0.0, 0.0) + HEIGHT
        return np.array([height_at(self.relief, x, y) for x, y in xy]) - foot


def field(rms: float, rng: np.random.Generator) -> F64:
    """Isotropic height field of ISO 8608's slope (2-D exponent -3), given rms over 0.011-2.83 cycles/m."""
    n = int(2 * HALF / CELL) + 1
    f = np.hypot(np.fft.fftfreq(n, CELL)[:, None], np.fft.rfftfreq(n, CELL)[None])
    f[0, 0] = np.inf
    spectrum = np.where((f > 0.011) & (f < 2.0), f**-1.5, 0)
    z = np.fft.irfft2(np.fft.rfft2(rng.normal(size=(n, n))) * spectrum, (n, n))
    return np.asarray(rms * z / z.std())


@numba.njit(cache=True)
def height_at(z: F64, x: float, y: float) -> float:
    u, v = (x + 90.0) / 0.25, (y + 90.0) / 0.25
    i, j = min(max(int(u), 0), len(z) - 2), min(max(int(v), 0), len(z) - 2)
    a, b = u - i, v - j
    low = z[i, j] * (1 - b) + z[i, j + 1] * b
    return (1 - a) * low + a * (z[i + 1, j] * (1 - b) + z[i + 1, j + 1] * b)


@numba.njit(cache=True)
def cast(z: F64, origin: F64, direction: F64, boxes: F64, limit: float) -> tuple[F64, I32]:
    """Range (n,) and object (n,) of rays; boxes (k, 8): x, y, z low, l, w, h, yaw, object."""
    n = len(direction)
    reach, hit = np.full(n, np.inf), np.full(n, -1, np.int32)
    for i in range(n):
        d, t = direction[i], 0.5
        while t < limit:
            gap = origin[2] + t * d[2] - height_at(z, origin[0] + t * d[0], origin[1] + t * d[1])
            if gap < 0.002:  # the last bit by the secant
                u = t + 0.02
                later = origin[2] + u * d[2] - height_at(z, origin[0] + u * d[0], origin[1] + u * d[1])
                reach[i] = t + 0.02 * gap / max(gap - later, 1e-4)
                break
            t += max(0.002, gap / (abs(d[2]) + 1.0))
        for k in range(len(boxes)):
            b = boxes[k]
            c, s = np.cos(b[6]), np.sin(b[6])
            ox, oy = origin[0] - b[0], origin[1] - b[1]
            o = (c * ox + s * oy, -s * ox + c * oy, origin[2] - b[2] - b[5] / 2)
            e = (c * d[0] + s * d[1], -s * d[0] + c * d[1], d[2])
            near, far = 0.0, limit
            for axis in range(3):
                half = b[3 + axis] / 2
                if abs(e[axis]) < 1e-12:
                    if abs(o[axis]) > half:
                        far = -1.0
                    continue
                t0, t1 = (-half - o[axis]) / e[axis], (half - o[axis]) / e[axis]
                near, far = max(near, min(t0, t1)), min(far, max(t0, t1))
            if near <= far and near < reach[i]:
                reach[i], hit[i] = near, np.int32(b[7])
    return reach, hit


def car(x: float, y: float, ground: float, yaw: float, number: int) -> list[list[float]]:
    """Body, cabin and four wheels."""
    c, s = np.cos(yaw), np.sin(yaw)
    parts = [
        [x, y, ground + 0.25, 4.3, 1.8, 0.55, yaw, number],
        [x, y, ground + 0.8, 2.2, 1.6, 0.65, yaw, number],
    ]
    for u, v in ((1.4, 0.8), (1.4, -0.8), (-1.4, 0.8), (-1.4, -0.8)):
        parts.append([x + c * u - s * v, y + s * u + c * v, ground, 0.6, 0.2, 0.6, yaw, number])
    return parts


def objects(z: F64, rng: np.random.Generator, cars: int, people: int, walls: int) -> F64:
    parts: list[list[float]] = []
    for number in range(cars + people + walls):
        r, a = rng.uniform(6, 40), rng.uniform(-np.pi, np.pi)
        x, y, yaw = r * np.cos(a), r * np.sin(a), rng.uniform(-np.pi, np.pi)
        g = height_at(z, x, y)
        if number < cars:
            parts += car(x, y, g, yaw, number)
        elif number < cars + people:
            parts.append([x, y, g - 0.02, 0.45, 0.45, 1.75, yaw, number])
        else:
            parts.append([1.3 * x, 1.3 * y, g - 1.0, 12, 0.3, 4.0, yaw, number])
    return np.array(parts).reshape(-1, 8)


def make_scene(
    roughness: str = "E",
    grade: float = 0.0,
    seed: int = 0,
    columns: int = 1042,
    cars: int = 12,
    people: int = 5,
    walls: int = 4,
    noise: float = 0.01,
    beside: bool = False,
) -> Scene:
    """One sweep over a field of that roughness, rising by `grade` [m/m] along +x and half of it along y.

    With `beside` a car stands 3 m to the left, object 99, and a high wall behind it, so that nothing is
    seen beyond.
    """
    rng = np.random.default_rng(seed)
    z = field(ROUGHNESS[roughness], rng)
    xs = np.linspace(-HALF, HALF, len(z))
    z = z + grade * xs[:, None] + 0.5 * grade * xs[None]
    boxes = objects(z, rng, cars, people, walls)
    if beside:
        foot = height_at(z, 0.0, 3.9)
        wall = [0.0, 5.2, foot - 2.0, 30.0, 0.3, 8.0, 0.0, 100]
        boxes = np.concatenate([boxes, car(0.0, 3.9, foot, 0.0, 99), [wall]])
    elevation = np.radians(np.concatenate([np.linspace(2.4, -7.8, 32), np.linspace(-8.4, -23.8, 32)]))
    azimuth = np.pi - 2 * np.pi * (np.arange(columns) + 0.5) / columns
    e, a = (g.ravel() for g in np.meshgrid(elevation, azimuth, indexing="ij"))
    direction = np.column_stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    origin = np.array([0, 0, height_at(z, 0.0, 0.0) + HEIGHT])
    reach, hit = cast(z, origin, direction, boxes, 80.0)
    seen = np.isfinite(reach) & (rng.random(len(reach)) > 0.01) & (reach > 0.9)
    reach = reach + rng.normal(0, noise, len(reach)) if noise else reach
    points = direction[seen] * reach[seen, None]
    height = np.array([height_at(z, x, y) for x, y in points[:, :2]]) - origin[2]
    ring = np.repeat(np.arange(64, dtype=np.uint8), columns)[seen]
    return Scene(points.astype(np.float32), ring, hit[seen] == -1, height, hit[seen], z)


def scores(scene: Scene, is_ground: Bool, movers: int = 17, limit: float = 50.0) -> tuple[float, float]:
    """F1 of ground within `limit` and leak of the first `movers` objects (vehicles, persons)."""
    near = np.hypot(scene.points[:, 0], scene.points[:, 1]) < limit
    truth, said = scene.is_ground[near], is_ground[near]
    f1 = 2 * np.sum(truth & said) / (np.sum(truth) + np.sum(said))
    mover = ((scene.object >= 0) & (scene.object < movers))[near]
    return float(f1), float(said[mover].mean())


@pytest.fixture(scope="session")
def scene() -> Callable[..., Scene]:
    return make_scene


@pytest.fixture(scope="session")
def judge() -> Callable[..., tuple[float, float]]:
    return scores
