"""Scenes in which something hides behind a wall and comes out again: one motion and duration each.

The ego is parked. On either side of it stands a wall; behind it run two lanes, on each of which a vehicle
or a person comes, hides for the time that is asked for, and goes on. With confusers another one meets it, or
runs beside it, within 4 m while it is hidden; without, another follows on the same way. The farther lane is
the nearer one drawn larger, and slower by so much that accelerations are the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from datmo.arrays import F64
from scenarios.spec import Actor, Ego, Scenario, Terrain, Thing, Traffic
from scenarios.spec.actors import ActorKind, WayPoint

Motion = Literal["straight", "turning", "stop-and-go"]
MOTIONS: tuple[Motion, ...] = ("straight", "turning", "stop-and-go")
EGO = np.array([2.0, -50.0])  # where a parked ego stands, facing +y
STEP, BEFORE, AFTER = 0.1, 1.0, 1.5  # [s] of way-points; what is seen before and after
HIDES = 2.0, 3.2  # [s] when the first one is wholly hidden
LATE = 3.2, 4.0  # [s] by which another follows
FARTHER = 1.5, 1.8  # the farther lane over the nearer
SLOW = 0.5  # [s] by which vehicles that stop are hidden longer: they are slow to come out
LENGTH = {"car": 4.5, "van": 5.2, "bicycle": 1.8, "pedestrian": 0.6}
VARIANTS = {"car": 3, "van": 1, "bicycle": 1, "pedestrian": 2}
WALL_HEIGHT = 3.2  # [m] taller than what hides and than the sensor
FINE = 0.02  # [s] of the integration of a path


@dataclass(frozen=True)
class Course:
    """A way behind a wall: along the lane (s) and away from the ego (d), by time.

    Attributes:
        times: (n,) [s]. s, d: (n,) [m].
        hide, show: when it is wholly hidden from, and when it comes out [s].
    """

    times: F64
    s: F64
    d: F64
    hide: float
    show: float

    def at(self, time: float) -> tuple[float, float]:
        """s and d [m] at a time [s]."""
        return float(np.interp(time, self.times, self.s)), float(np.interp(time, self.times, self.d))


def recovery_scene(motion: Motion, seconds: tuple[float, float], confusers: bool, seed: int) -> Scenario:
    """A scene with the motion, and a time hidden within `seconds` [s], on either side of the ego."""
    rng = np.random.default_rng([seed, MOTIONS.index(motion), round(10 * seconds[0]), confusers])
    duration = round(HIDES[1] + seconds[1] + LATE[1] + AFTER, 1)
    actors: list[Actor] = []
    things: list[Thing] = []
    for side in (-1.0, 1.0):
        passing, wall = _stage(motion, seconds, confusers, side, duration, rng)
        actors += passing
        things.append(wall)
    named = [actor.model_copy(update={"name": f"{actor.name}-{i}"}) for i, actor in enumerate(actors)]
    return Scenario(
        name=f"hidden-{motion}-{seed}",
        summary=f"{motion} behind walls for {seconds[0]:g} to {seconds[1]:g} s",
        duration=duration,
        terrain=Terrain(grade=float(rng.uniform(-0.05, 0.05)), roughness="C", road_roughness="A"),
        traffic=Traffic(environment=None, vehicles=0, warm_up=0.0),
        ego=Ego(control="parked"),
        actors=tuple(named),
        things=tuple(things),
    )


def _stage(
    motion: Motion,
    seconds: tuple[float, float],
    confusers: bool,
    side: float,
    duration: float,
    rng: np.random.Generator,
) -> tuple[list[Actor], Thing]:
    """Those who pass on one side, and the wall that hides them."""
    kind: ActorKind = str(rng.choice(["car", "car", "car", "van", "bicycle", "pedestrian"]))  # type: ignore[assignment]
    if motion == "turning" and kind == "pedestrian":
        kind = "car"
    if motion == "stop-and-go" and seconds[1] <= 1:
        kind = "pedestrian"  # no other stops and goes on in so short a time
    way = float(rng.choice([-1.0, 1.0]))
    lane = float(rng.uniform(9, 13) if kind == "pedestrian" else rng.uniform(12, 18))
    course = _course(motion, kind, lane, float(rng.uniform(*seconds)), duration, rng)
    wall_at = float(rng.uniform(0.45, 0.6)) * course.d.min()
    actors = []
    for scale in (1.0, float(rng.uniform(*FARTHER))):
        own = _larger(course, scale)
        actors.append(_actor("owner", kind, own, side, way, 0.0, rng))
        if confusers:
            actors.append(_confuser(kind, own, scale * lane, side, way, rng))
        else:
            late = float(rng.uniform(*LATE)) * np.sqrt(scale)
            actors.append(_actor("follower", kind, own, side, way, late, rng))
    return actors, _wall(course, LENGTH[kind], wall_at, side, way)


def _larger(course: Course, scale: float) -> Course:
    """The same way from the ego's place, `scale` times as large, with the same accelerations."""
    slower = float(np.sqrt(scale))
    times = slower * course.times
    return Course(times, scale * course.s, scale * course.d, slower * course.hide, slower * course.show)


def _course(
    motion: Motion, kind: str, lane: float, hidden: float, duration: float, rng: np.random.Generator
) -> Course:
    """Speed and heading over time, integrated; the middle of the hidden way lies abreast of the ego."""
    t = np.arange(-BEFORE, duration + BEFORE, FINE)
    hide = float(rng.uniform(*HIDES))
    top = {"pedestrian": (1.1, 1.7), "bicycle": (3.5, 5.5)}.get(kind, (5.0, 11.0 if hidden < 2.5 else 8.0))
    cruise = float(rng.uniform(*top))
    speed = cruise * (1 + 0.08 * np.sin(2 * np.pi * (t / rng.uniform(4, 8) + rng.uniform())))
    heading = np.zeros(len(t))
    if motion == "stop-and-go":
        hidden = hidden if kind == "pedestrian" else max(hidden - SLOW, FINE)
        speed = _stopping(t, cruise, hide, hidden, rng)
    if motion == "turning":
        heading = _turning(t, cruise, hide, hidden, rng)
    s = np.cumsum(speed * np.cos(heading)) * FINE
    d = lane + np.cumsum(speed * np.sin(heading)) * FINE
    show = hide + hidden
    middle = (np.interp(hide, t, s) + np.interp(show, t, s)) / 2
    return Course(t, s - middle, d, hide, show)


def _stopping(t: F64, cruise: float, hide: float, hidden: float, rng: np.random.Generator) -> F64:
    """Braking, a stand while hidden, going on."""
    brake, start = rng.uniform(2.0, 3.5), rng.uniform(1.5, 2.5)
    stand = hide + rng.uniform(0.15, 0.6) * hidden
    go = stand + min(rng.uniform(0.2, 0.8), 0.4 * hidden)
    down = np.clip(brake * (stand - t), 0, cruise)
    up = np.clip(start * (t - go), 0, cruise)
    return np.asarray(np.where(t < go, down, up))


def _turning(t: F64, cruise: float, hide: float, hidden: float, rng: np.random.Generator) -> F64:
    """A turn away from the ego that begins about when it hides; sideways no more than 3 m/s²."""
    rate = min(rng.uniform(0.25, 0.6), 3.0 / cruise)
    sweep = np.deg2rad(rng.uniform(20, 45))
    begin = hide + rng.uniform(-0.5, max(0.0, hidden - 0.6))
    return np.asarray(np.clip(rate * (t - begin), 0, sweep))


def _actor(
    name: str, kind: ActorKind, course: Course, side: float, way: float, late: float, rng: np.random.Generator
) -> Actor:
    times = np.arange(course.times[0], course.times[-1] - late, STEP)
    s, d = np.interp(times, course.times, course.s), np.interp(times, course.times, course.d)
    path = tuple(
        WayPoint(t=round(float(t + late), 3), x=float(EGO[0] + side * b), y=float(EGO[1] + way * a))
        for t, a, b in zip(times, s, d, strict=True)
    )
    return Actor(name=name, kind=kind, path=path, variant=int(rng.integers(VARIANTS[kind])))


def _confuser(
    kind: ActorKind, course: Course, lane: float, side: float, way: float, rng: np.random.Generator
) -> Actor:
    """Another of its kind that meets it while it is hidden, on the lane behind, or keeps beside it."""
    gap = 1.2 if kind in ("pedestrian", "bicycle") else 3.4
    meet = float(rng.uniform(course.hide, course.show))
    speed = float(np.ptp(course.s) / np.ptp(course.times) * rng.uniform(0.8, 1.2))
    onward = bool(rng.random() < 0.3)
    along = (1 if onward else -1) * max(speed, 1.0) * (1.15 if onward else 1.0)
    s = course.at(meet)[0] + along * (course.times - meet)
    other = Course(course.times, s, np.maximum(course.d, lane) + gap, course.hide, course.show)
    return _actor("confuser", kind, other, side, way, 0.0, rng)


def _wall(course: Course, length: float, wall_at: float, side: float, way: float) -> Thing:
    """A wall along the lane that hides all of `length` [m] from `hide` to `show`."""
    (s0, d0), (s1, d1) = course.at(course.hide), course.at(course.show)
    begin, end = (s0 - length / 2) * wall_at / d0, (s1 + length / 2) * wall_at / d1
    center = (EGO[0] + side * wall_at, EGO[1] + way * (begin + end) / 2)
    return Thing(kind="wall", at=center, size=(float(end - begin), 0.3, WALL_HEIGHT), yaw_deg=90.0)
