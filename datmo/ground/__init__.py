"""The ground stage: `segment_ground(points)` and, for a stream, `GroundSegmenter(config).step`."""

from datmo.ground.config import GroundConfig
from datmo.ground.segment import METHODS, GroundSegmenter, segment_ground
from datmo.ground.surface import PolarSurface

__all__ = ["METHODS", "GroundConfig", "GroundSegmenter", "PolarSurface", "segment_ground"]
