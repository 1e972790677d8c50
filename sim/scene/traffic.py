"""highway-env as the world needs it: its roads, its drivers, its vehicle model and its actions.

Its map is mirrored into the world as (x, -y), headings as -heading. Vehicles are its IDM drivers,
each on a course of lanes; what they wish for is cut down by the right of way, see `flow`.
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

from datmo.arrays import F64
from datmo.errors import ScenarioError, nearest
from datmo.geometry import wrap_angle
from scenarios.spec import Scenario
from sim.scene.autopilot import STEP, Mover
from sim.scene.course import NEAR, Course, Key, Lane, crossings, follow, onward
from sim.scene.population import Arrival, asking
from sim.scene.strict import check
from sim.scene.vehicles import Body, State

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import highway_env  # noqa: F401  # registers its environments
    from highway_env.envs.common.action import ActionType
    from highway_env.road.lane import StraightLane
    from highway_env.road.road import Road as HighwayRoad
    from highway_env.road.road import RoadNetwork
    from highway_env.vehicle.behavior import IDMVehicle
    from highway_env.vehicle.controller import ControlledVehicle, MDPVehicle
    from highway_env.vehicle.dynamics import BicycleVehicle
    from highway_env.vehicle.kinematics import Vehicle

EXTEND = 200.0
"""Roads that end are made longer by this much [m]."""

EGO_ID = 0
AHEAD, ASIDE, BENT = 6.0, 2.5, np.deg2rad(75)
"""A lane goes on in another that begins within so much of its end, along and across, and turns so much:
the arms of roundabout-generic meet their ring at 66 degrees."""
FAR = 2000.0  # courses are at least this long where the road allows [m]
_IDM = {"DISTANCE_WANTED": 10.0, "COMFORT_ACC_MAX": 3.0, "COMFORT_ACC_MIN": -5.0}
"""Of highway-env's IDM; its intersection leaves them changed for every environment of the process."""


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
    COMFORT_ACC_MAX = 3.0
    COMFORT_ACC_MIN = -3.0
    DISTANCE_WANTED = 8.0
    TIME_WANTED = 1.0

    def __init__(self, road: Any, arrival: Arrival) -> None:
        self.course, self.leg, self.name, self.body = arrival.course, 0, arrival.id, arrival.body
        self.before = 0.0  # the acceleration of the last step [m/s²]
        lane, arc = road.network.get_lane(self.course.keys[0]), arrival.arc
        super().__init__(road, lane.position(arc, 0.0), lane.heading_at(arc), arrival.speed)
        self.LENGTH, self.WIDTH = self.body.length, self.body.width
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
        wish = float(self.action["acceleration"])
        return asking(
            self.name, self.body, self.course, self.rear, float(self.speed), wish, self.before, first
        )

    def drive(self, acceleration: float) -> None:
        """Take another acceleration than the wished one [m/s²]."""
        self.before = self.action["acceleration"] = acceleration


def make(scenario: Scenario) -> Any:
    """The highway-env environment of a scenario, configured, or None.

    Raises:
        ScenarioError: it is unknown, has no such configuration key, or wants another type of value there.
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
        env: Any = gym.make(name, disable_env_checker=True).unwrapped
        check(config, env.config, ActionType, f"of {name}", "traffic.config")
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
    space: Space[Any] = env.action_space
    return space


def straight_network() -> RoadNetwork:
    """Two lanes along y through the origin, for scenarios without an environment."""
    network = RoadNetwork()
    for nodes, x, sign in ((("s", "m", "n"), 2.0, 1.0), (("N", "M", "S"), -2.0, -1.0)):
        for a, b, start in ((nodes[0], nodes[1], -100.0), (nodes[1], nodes[2], 0.0)):
            ends = mirrored([[x, sign * start], [x, sign * (start + 100.0)]])
            network.add_lane(a, b, StraightLane(*ends, speed_limit=15.0))
    return network


def goes_on(lane: Any, onward: Any) -> bool:
    """Whether a vehicle at the end of one lane is about at the beginning of the other, and heads along it."""
    along, aside = onward.local_coordinates(lane.position(lane.length, 0))
    turn = wrap_angle(onward.heading_at(0) - lane.heading_at(lane.length))
    return bool(abs(along) < AHEAD and abs(aside) < ASIDE and abs(turn) < BENT)


def _open(lane: Any, others: F64, start: float, end: float) -> bool:
    """Whether a lane is straight and no other lies on it between two arc lengths, as parking rows do."""
    if type(lane) is not StraightLane:
        return False
    along, aside = (others - lane.start) @ lane.direction, (others - lane.start) @ lane.direction_lateral
    return not ((along > start) & (along < end) & (np.abs(aside) < NEAR)).any()


def extend(network: RoadNetwork) -> dict[Key, Lane]:
    """Lengthen the straight lanes at which roads end, in place, and list all lanes in the world."""
    lanes = network.lanes_dict()
    joints = [(a, b) for a in lanes for b in lanes if a != b and goes_on(lanes[a], lanes[b])]
    led_to, leading = {b for _, b in joints}, {a for a, _ in joints}
    listed: dict[Key, tuple[bool, bool, float]] = {}
    drawn = [np.array([lane.position(s, 0) for s in np.arange(0.0, lane.length)]) for lane in lanes.values()]
    points, owner = np.concatenate(drawn), np.repeat(np.arange(len(drawn)), [len(part) for part in drawn])
    for i, (key, lane) in enumerate(lanes.items()):
        entry, leaving = key not in led_to, key not in leading
        others = points[owner != i]
        before = EXTEND * (entry and _open(lane, others, -EXTEND, -2 * NEAR))
        after = EXTEND * (leaving and _open(lane, others, lane.length + 2 * NEAR, lane.length + EXTEND))
        listed[key] = entry, leaving, after
        if before or after:
            a = lane.position(-before, 0)
            b = lane.position(lane.length + after, 0)
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


def state_of(vehicle: Any, name: int, looks: Body) -> State:
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


class Highway:
    """A map of highway-env with vehicles on it.

    Args:
        scenario: names the environment. seed: of what the environment draws on reset.

    Attributes:
        lanes: by key, in the world. limits: their speed limits [m/s]. first: the ego's lane.
        start: (2,) of the ego at the first scan, if nothing holds it up [m, world].
        road: highway-env's. env: its environment, or None.
    """

    def __init__(self, scenario: Scenario, seed: int, rng: np.random.Generator) -> None:
        self.scenario, self.env, self._rng = scenario, make(scenario), rng
        network, position, heading = self._map(seed)
        self.first: Key = network.get_closest_lane_index(position, heading)
        self.lanes = extend(network)
        self.limits = {key: float(network.get_lane(key).speed_limit or 20.0) for key in self.lanes}
        self.road = HighwayRoad(network, np_random=rng)
        lane, ego = network.get_lane(self.first), scenario.ego
        arc = float(lane.local_coordinates(position)[0])
        if ego.start is not None:
            arc = max(lane.length - self.lanes[self.first].added - ego.start, 5.0)
        self.start = mirrored(lane.position(arc, 0))
        self._arc = arc

    def ego(self, looks: Body) -> Any:
        """The ego, so far back that it is at its start when the warm-up has been played."""
        ego, lane = self.scenario.ego, self.road.network.get_lane(self.first)
        if ego.control == "parked":
            return Vehicle(self.road, lane.position(self._arc, 0), lane.heading_at(self._arc), 0.0)
        lead = self.scenario.traffic.warm_up + 1.0 / self.scenario.rate
        arc = max(self._arc - ego.speed * lead, 5.0)
        route = self._route()
        if ego.control == "autopilot":
            names = {key: i for i, key in enumerate(self.lanes)}
            course = Course(follow(self.lanes, route, FAR, self._rng), names)
            return self.drive(Arrival(EGO_ID, course, arc, ego.speed, looks))
        kind = self.env.action_type.vehicle_class
        made = kind(self.road, lane.position(arc, 0), lane.heading_at(arc), ego.speed)
        if isinstance(made, ControlledVehicle):
            made.route = list(route)
        self.env.road, self.env.controlled_vehicles = self.road, [made]
        with quiet():
            self.env.define_spaces()
        return made

    def top_speed(self, ego: Any, cruise: float) -> float:
        """The most that the ego may drive [m/s]: the autopilot its cruise, an agent what it can."""
        if isinstance(ego, MDPVehicle):
            return max(cruise, float(max(ego.target_speeds)))
        return cruise if isinstance(ego, Driver) else max(cruise, float(ego.MAX_SPEED))

    def drive(self, arrival: Arrival) -> Driver:
        """A driver on this map."""
        return Driver(self.road, arrival)

    def _map(self, seed: int) -> tuple[RoadNetwork, F64, float]:
        """The road network as highway-env makes it, and where it puts the ego [its own map]."""
        if self.env is None:
            return straight_network(), mirrored([2.0, -50.0]), -np.pi / 2
        for name, value in _IDM.items():
            setattr(IDMVehicle, name, value)
        with quiet():
            self.env.reset(seed=seed)
        ego = self.env.vehicle
        return self.env.road.network, ego.position.copy(), float(ego.heading)

    def _goal(self) -> str | None:
        """The node that the environment's config sends the ego to, or that it planned for it, if any."""
        if self.env is None:
            return None
        plan = getattr(self.env.vehicle, "route", None)
        return self.env.config.get("destination") or (plan[-1][1] if plan else None)

    def _route(self) -> list[Key]:
        """The ego's lanes to its goal, one that joins the other."""
        keys, goal = [self.first], self._goal()
        nodes = self.road.network.shortest_path(self.first[1], goal) if goal else []
        for a, b in pairwise(nodes):
            joined = [lane.key for lane in onward(self.lanes, self.lanes[keys[-1]]) if lane.key[:2] == (a, b)]
            keys.append(joined[0] if joined else (a, b, 0))
        return keys
