"""The messages that pass between the rooms; nothing else does."""

from datmo.messages.base import (
    CYCLES,
    GROUNDS,
    PERSONS,
    VEHICLES,
    FalseReturn,
    Kind,
    Message,
    Status,
    Visibility,
)
from datmo.messages.frame import Frame
from datmo.messages.ground import Ground, Plane, Surface
from datmo.messages.objects import Boxes, Clusters, Detections, Tracks
from datmo.messages.scan import Scan
from datmo.messages.sight import Sight
from datmo.messages.truth import LostRays, Relief, Truth, is_any, visibility

__all__ = [
    "CYCLES",
    "GROUNDS",
    "PERSONS",
    "VEHICLES",
    "Boxes",
    "Clusters",
    "Detections",
    "FalseReturn",
    "Frame",
    "Ground",
    "Kind",
    "LostRays",
    "Message",
    "Plane",
    "Relief",
    "Scan",
    "Sight",
    "Status",
    "Surface",
    "Tracks",
    "Truth",
    "Visibility",
    "is_any",
    "visibility",
]
