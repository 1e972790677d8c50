"""The tracks stage: boxes over time become tracks that keep their identity.

from datmo.tracks import Tracker
tracks = Tracker().step(boxes, stamp, sight=None)
"""

from datmo.tracks.config import TrackerConfig
from datmo.tracks.tracker import Tracker

__all__ = ["Tracker", "TrackerConfig"]
