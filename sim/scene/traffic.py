"""Traffic from highway-env: its roads, its drivers and its vehicle model, under our right of way.

Its map is mirrored into the world as (x, -y), headings as -heading. Vehicles are its IDM drivers,
each on a course of lanes; the acceleration they wish for is cut down by `RightOfWay`.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Discrete, Space

from datmo.arrays import F64, Bool
from datmo.errors import ScenarioError, nearest
from scenarios.spec import Scenario
from sim.scene.autopilot import FIRM, GAP, HARD, STEP, Claim, Mover, RightOfWay, braking, stretch
from sim.scene.course import Course, Key, Lane, crossings, follow
from sim.scene.roads import Road
from sim.scene.vehicles import FLEET, Body, Places, State, body

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import highway_env  # noqa: F401  # registers its environments
    from highway_env.road.lane import StraightLane
    from highway_env.road.road import Road as HighwayRoad
    from highway_env.road.road import RoadNetwork
    from highway_env.vehicle.behavior import IDMVehicle
    from highway_env.vehicle.controller import ControlledVehicle
    from highway_env.vehicle.dynamics import BicycleVehicle
    from highway_env.vehicle.kinematics import Vehicle

EXTEND = 200.0
"""Roads that end are made longer by this much [m]."""

EGO_ID, FIRST_ID = 0, 1001
EGO = "car/0"
PAST_END = 20.0  # the ego has arrived this far before the end of the original road [m]
LOOK = 70.0  # the way ahead that the right of way is told [m]
FAR = 2000.0  # courses are at least this long where the road allows [m]
OUTSIDE = 8.0  # beyond the sensor's range, vehicles appear and vanish [m]
STOCK = 60.0  # width of the ring out there in which the next ones wait [m]
_IDM = {
    name: getattr(IDMVehicle, name)
    for name in ("DISTANCE_WANTED", "COMFORT_ACC_MAX", "COMFORT_ACC_MIN", "TIME_WANTED", "ACC_MAX", "DELTA")
}


@contextmanager
def quiet() -> Iterator[None]:
    """highway-env warns that its ids are out of date and that its own arguments are deprecated."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def mirrored(xy: Any) -> F64:
    """From highway-env's map to the world, and back."""
    return np.asarray(xy, float) * (1.0, -1.0)


class Driver(IDMVehicle):  # type: ignore[misc]
    """An IDM driver that keeps to a course of lanes; it never turns round at the end of the road."""

    ACC_MAX = 5.0
    COMFORT_ACC_MAX = 2.5
    COMFORT_ACC_MIN = -3.0
    DISTANCE_WANTED = 8.0
    TIME_WANTED = 1.0

    def __init__(self, road: Any, course: Course, arc: float, speed: float, name: int, body: Body) -> None:
        lane = road.network.get_lane(course.keys[0])
        self.course, self.leg, self.name, self.body = course, 0, name, body
        super().__init__(road, lane.position(arc, 0.0), lane.heading_at(arc), speed)
        self.LENGTH, self.WIDTH = body.length, body.width
        self.check_collisions = self.collidable = self.enable_lane_change = False
        self.on_state_update()
        self.target_lane_index = self.lane_index

    def follow_road(self) -> None:
        """The target is the lane of the course that the vehicle is on."""
        self.target_lane_index = self.lane_index

    def on_state_update(self) -> None:
        """Move on to the next lane of the course at the end of this one."""
        index = self.course.keys[self.leg]
        lane = self.road.network.get_lane(index)
        self.arc = lane.local_coordinates(self.position)[0]
        if self.arc >= lane.length and self.leg + 1 < len(self.course.keys):
            self.leg += 1
            self.on_state_update()
            return
        self.lane_index, self.lane = index, lane

    @property
    def rear(self) -> float:
        """Arc length of the rear bumper along the course [m]."""
        return float(self.course.starts[self.leg] + self.arc - self.body.length / 2)

    def mover(self, first: bool) -> Mover:
        """What the right of way has to know."""
        behind = max(self.rear, 0.0)
        return Mover(
            self.name,
            self.course.ahead(behind, self.body.length + LOOK),
            self.body.length,
            self.body.width,
            max(float(self.speed), 0.0),
            float(self.action["acceleration"]),
            float(self.before),
            self.course.zone(behind),
            first,
        )

    before = 0.0
    """The acceleration of the last step [m/s²]."""


def make(scenario: Scenario) -> Any:
    """The highway-env environment of a scenario, configured, or None.

    Raises:
        ScenarioError: it is unknown, or has no such configuration key.
    """
    name, config = scenario.traffic.environment, scenario.traffic.config
    if name is None:
        return None
    known = [key for key, spec in gym.registry.items() if "highway_env." in str(spec.entry_point)]
    if name not in known:
        raise ScenarioError(
            f"traffic.environment = {name!r} is no environment of highway-env; {nearest(name, known)}"
        )
    with quiet():
        env = gym.make(name, disable_env_checker=True).unwrapped
        for key in config:
            if key not in env.config:
                raise ScenarioError(f"traffic.config.{key} is no key of {name}; {nearest(key, env.config)}")
        env.configure({**config, "observation": {"type": "AttributesObservation", "attributes": []}})
        env.define_spaces()
    return env


def action_space(scenario: Scenario) -> Space[Any]:
    """`Discrete(1)` where the ego drives or stands by itself, else highway-env's action space."""
    if scenario.ego.control != "agent":
        return Discrete(1)
    env = make(scenario)
    if env is None:
        raise ScenarioError("ego.control = 'agent' needs traffic.environment; choose a highway-env id")
    return env.action_space


def straight_network() -> RoadNetwork:
    """Two lanes along y through the origin, for scenarios without an environment."""
    network = RoadNetwork()
    for nodes, x, sign in ((("s", "m", "n"), 2.0, 1.0), (("N", "M", "S"), -2.0, -1.0)):
        for a, b, start in ((nodes[0], nodes[1], -100.0), (nodes[1], nodes[2], 0.0)):
            ends = mirrored([[x, sign * start], [x, sign * (start + 100.0)]])
            network.add_lane(a, b, StraightLane(*ends, speed_limit=15.0))
    return network


def extend(network: RoadNetwork) -> dict[Key, Lane]:
    """Lengthen the straight lanes at which roads end, in place, and list all lanes in the world."""
    lanes = network.lanes_dict()
    ends = np.array([lane.position(lane.length, 0) for lane in lanes.values()])
    starts = np.array([lane.position(0, 0) for lane in lanes.values()])
    listed: dict[Key, tuple[bool, bool]] = {}
    for key, lane in lanes.items():
        entry = bool(np.hypot(*(ends - lane.position(0, 0)).T).min() > 1.0)
        leaving = bool(np.hypot(*(starts - lane.position(lane.length, 0)).T).min() > 1.0)
        listed[key] = entry, leaving
        if type(lane) is StraightLane and (entry or leaving):
            a = lane.position(-EXTEND if entry else 0.0, 0)
            b = lane.position(lane.length + (EXTEND if leaving else 0.0), 0)
            lane.__init__(a, b, lane.width, lane.line_types, lane.forbidden, lane.speed_limit, lane.priority)
    lines = {}
    for key, lane in lanes.items():
        arcs = np.linspace(0, lane.length, max(int(lane.length / STEP), 2))
        lines[key] = mirrored([lane.position(s, 0) for s in arcs])
    cross = crossings(lines)
    return {
        key: Lane(key, lines[key], float(lane.length), float(lane.width_at(0)), key in cross, *listed[key])
        for key, lane in lanes.items()
    }


class Traffic:
    """Vehicles on roads, the ego among them.

    At the start of each sweep `refresh`, then some times `step`. About `traffic.vehicles` are
    kept within the sensor's range; they appear and vanish beyond it only.

    Args:
        scenario: what is to happen.
        seed: of everything random here.

    Attributes:
        roads: one a lane. way: the right of way, shared with walkers and scripts.
        start: (2,) where the ego is at the first scan if nothing holds it up [m, world].
        drivers: all vehicles but the ego.
    """

    def __init__(self, scenario: Scenario, seed: np.random.SeedSequence) -> None:
        self.scenario = scenario
        self.rng = np.random.default_rng(seed)
        self.env = make(scenario)
        network, position, heading = self._map(int(seed.generate_state(1)[0]))
        self._first = network.get_closest_lane_index(position, heading)
        self.lanes = extend(network)
        self.names = {key: i for i, key in enumerate(self.lanes)}
        self.roads = tuple(Road(lane.line, lane.width) for lane in self.lanes.values())
        self.road = HighwayRoad(network, np_random=self.rng)
        self.way = RightOfWay()
        self.drivers: list[Driver] = []
        self.body = body(EGO)
        self.ego = self._make_ego(network.get_lane(self._first), position)
        self.road.vehicles.append(self.ego)
        self._places = Places(self.lanes)

    def populate(self) -> None:
        """The vehicles of the start: within range of the ego's way, and those that come next."""
        count, reach = self.scenario.traffic.vehicles, self.scenario.sensor.range
        if count == 0:
            return
        self._claim_ego()
        direction = self.lanes[self._first].direction(0.0)
        near = self._places.within(self.start, 0, reach - 10)
        near &= self._places.within(self.start + 50 * direction, 0, reach - 10) & ~self._kept_clear()
        coming = near & self._places.towards(self.start + 50 * direction)
        for tries in range(60 * count):
            if len(self.drivers) >= count + 4:
                break
            self._appear(near if tries % 4 == 0 else coming)
        self._restock(self.start)

    def refresh(self) -> None:
        """Vehicles vanish far off, and new ones appear out of the sensor's range."""
        centre, far = self.ego_state().xy, self.scenario.sensor.range + OUTSIDE
        near = [d for d in self.drivers if np.hypot(*(mirrored(d.position) - centre)) < far + STOCK]
        if len(near) < len(self.drivers):
            self.drivers = near
            self.road.vehicles = [self.ego, *near]
        self._restock(centre)

    def step(self, dt: float) -> None:
        """Play `dt` seconds."""
        self.road.act()
        self._claim_ego()
        everyone = [*self.drivers, self.ego] if isinstance(self.ego, Driver) else self.drivers
        chosen = self.way.decide([d.mover(d is self.ego) for d in everyone], dt)
        for driver in everyone:
            driver.before = driver.action["acceleration"] = chosen[driver.name]
        self.road.step(dt)

    def act(self, action: Any) -> None:
        """Hand an agent's action to highway-env."""
        if self.scenario.ego.control == "agent" and action is not None:
            self.env.action_type.act(action)

    def states(self) -> list[State]:
        """All vehicles but the ego, by age."""
        return [_state(d, d.name, d.body) for d in self.drivers]

    def ego_state(self) -> State:
        """The ego."""
        return _state(self.ego, EGO_ID, self.body)

    def reachable(self, duration: float) -> F64:
        """Points (n, 2) that the ego may come to within `duration` [m, world]."""
        reach = self.scenario.ego.speed * duration + 10.0
        if isinstance(self.ego, Driver):
            points = self.ego.course.points
            first = int(np.argmin(np.hypot(*(points - self.start).T)))
            return points[first : first + max(int(reach / STEP), 2)]
        points = np.concatenate([lane.line for lane in self.lanes.values()])
        near = points[np.hypot(*(points - self.start).T) < reach]
        return self.start[None] if self.scenario.ego.control == "parked" else np.vstack([self.start, near])

    @property
    def arrived(self) -> bool:
        """Whether the ego has reached the end of the road as highway-env made it."""
        key = self.ego.lane_index
        if self.scenario.ego.control == "parked" or not self.lanes[key].leaving:
            return False
        along = self.ego.lane.local_coordinates(self.ego.position)[0]
        return bool(along >= self.lanes[key].length - EXTEND - PAST_END)

    def _map(self, seed: int) -> tuple[RoadNetwork, F64, float]:
        """The road network as highway-env makes it, and where it puts the ego [its own map]."""
        if self.env is None:
            return straight_network(), mirrored([2.0, -50.0]), -np.pi / 2
        for name, value in _IDM.items():  # another environment may have left them changed
            setattr(IDMVehicle, name, value)
        with quiet():
            self.env.reset(seed=seed)
        ego = self.env.vehicle
        return self.env.road.network, ego.position.copy(), float(ego.heading)

    def _make_ego(self, lane: Any, position: F64) -> Any:
        """The ego, so far back that it is at its start when the warm-up has been played."""
        ego, key = self.scenario.ego, self._first
        arc = float(lane.local_coordinates(position)[0])
        if ego.start is not None:
            arc = max(lane.length - EXTEND * self.lanes[key].leaving - ego.start, 5.0)
        self.start = mirrored(lane.position(arc, 0))
        if ego.control == "parked":
            return Vehicle(self.road, lane.position(arc, 0), lane.heading_at(arc), 0.0)
        lead = self.scenario.traffic.warm_up + 1.0 / self.scenario.rate
        arc = max(arc - ego.speed * lead, 5.0)
        route = self._route()
        if ego.control == "autopilot":
            course = Course(follow(self.lanes, route, FAR, self.rng), self.names)
            return Driver(self.road, course, arc, ego.speed, EGO_ID, self.body)
        kind = self.env.action_type.vehicle_class
        made = kind(self.road, lane.position(arc, 0), lane.heading_at(arc), ego.speed)
        if isinstance(made, ControlledVehicle):
            made.route = list(route)
        self.env.road, self.env.controlled_vehicles = self.road, [made]
        with quiet():
            self.env.define_spaces()
        return made

    def _route(self) -> list[Key]:
        """The ego's lanes to the destination that the environment's config names, if any."""
        first = self._first
        goal = self.env.config.get("destination") if self.env is not None else None
        nodes = self.road.network.shortest_path(first[1], goal) if goal else []
        pairs = pairwise(nodes)
        return [first, *((a, b, min(first[2], len(self.road.network.graph[a][b]) - 1)) for a, b in pairs)]

    def _claim_ego(self) -> None:
        """An ego that does not ask claims its body and its brake, straight ahead."""
        if isinstance(self.ego, Driver):
            return
        ego = self.ego_state()
        ahead = np.arange(
            -ego.body.length / 2, ego.body.length / 2 + braking(abs(self.ego.speed), HARD), STEP
        )
        points = ego.xy + ahead[:, None] * np.array([np.cos(ego.yaw), np.sin(ego.yaw)])
        self.way.place(EGO_ID, Claim(points, ego.body.width / 2))

    def _kept_clear(self) -> Bool:
        """The ego's first lane from behind it on: what it meets there early is the scenario's to say."""
        arc = self.ego.lane.local_coordinates(self.ego.position)[0]
        ahead = self.scenario.ego.speed * self.scenario.traffic.warm_up + 60
        return self._places.on(self._first, arc - 30, arc + ahead)

    def _restock(self, centre: F64) -> None:
        """Vehicles that come next wait in a ring beyond the range."""
        far = self.scenario.sensor.range + OUTSIDE
        wanted = self.scenario.traffic.vehicles
        waiting = [np.hypot(*(mirrored(d.position) - centre)) > far for d in self.drivers]
        missing = wanted - sum(waiting)
        if missing <= 0:
            return
        ring = self._places.within(centre, far, far + STOCK - 10) & self._places.towards(centre)
        for _ in range(3 * missing):
            self._appear(ring & ~self._kept_clear())

    def _appear(self, where: Bool) -> None:
        """A new vehicle at one of some places, unless somebody has, or needs, the ground there."""
        choice = np.flatnonzero(where)
        if len(choice) == 0:
            return
        i = int(choice[self.rng.integers(len(choice))])
        key, arc = self._places.keys[self._places.lane[i]], float(self._places.arc[i])
        limit = float(self.road.network.get_lane(key).speed_limit or 20.0)
        speed = float(np.clip(0.8 * limit + self.rng.normal(), 0.5 * limit, limit))
        looks = body(FLEET[int(self.rng.integers(len(FLEET)))])
        course = Course(follow(self.lanes, [key], arc + 500.0, self.rng), self.names)
        driver = Driver(self.road, course, arc, speed, FIRST_ID + self._made, looks)
        self._made += 1
        reach = looks.length + braking(speed, FIRM) + GAP
        mover = driver.mover(False)
        if mover.zone and mover.zone[0] < reach:
            return
        claim = stretch(mover, 0.0, reach)
        if self.way.free(claim, driver.name):
            self.way.place(driver.name, claim)
            self.drivers.append(driver)
            self.road.vehicles.append(driver)

    _made = 0
    """Vehicles tried so far: ids are never given twice."""


def _state(vehicle: Any, name: int, looks: Body) -> State:
    """A vehicle of highway-env in the world; its velocity lies off its heading by the side-slip."""
    if isinstance(vehicle, BicycleVehicle):
        rate = vehicle.derivative[:3, 0]
        velocity, yaw_rate = rate[:2], float(rate[2])
    else:
        slip = np.arctan(np.tan(vehicle.action["steering"]) / 2)
        along = vehicle.heading + slip
        velocity = vehicle.speed * np.array([np.cos(along), np.sin(along)])
        yaw_rate = float(vehicle.speed * np.sin(slip) / (vehicle.LENGTH / 2))
    xy = mirrored(vehicle.position)
    return State(name, looks, xy, -float(vehicle.heading), mirrored(velocity), -yaw_rate)
