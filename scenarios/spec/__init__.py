"""What a scenario may say: frozen, validated models, SI units in every description.

World frame: z up along gravity, x and y as on a map; the traffic's own map (highway-env's) is
mirrored into it as (x, -y). Lengths in metres, times in seconds, angles in degrees where the
name says so.
"""

from scenarios.spec.actors import Actor, WayPoint
from scenarios.spec.base import Model
from scenarios.spec.pedestrians import Pedestrian
from scenarios.spec.returns import IDEAL, Noise, Weather
from scenarios.spec.scenario import Bound, Scenario
from scenarios.spec.scenery import Parking, Row, Scenery, Strewn
from scenarios.spec.sensor import Sensor
from scenarios.spec.terrain import Terrain, TerrainFile
from scenarios.spec.things import Thing, ThingKind
from scenarios.spec.traffic import Ego, Traffic

__all__ = [
    "IDEAL",
    "Actor",
    "Bound",
    "Ego",
    "Model",
    "Noise",
    "Parking",
    "Pedestrian",
    "Row",
    "Scenario",
    "Scenery",
    "Sensor",
    "Strewn",
    "Terrain",
    "TerrainFile",
    "Thing",
    "ThingKind",
    "Traffic",
    "WayPoint",
    "Weather",
]
