"""The ground stage: `segment_ground(points)` and, for a stream, `GroundSegmenter(config).step`."""

from datmo.ground.config import GroundConfig
from datmo.ground.methods import METHODS
from datmo.ground.regression import Learned
from datmo.ground.segment import GroundSegmenter, segment_ground
from datmo.ground.surface import PolarSurface

__all__ = ["METHODS", "GroundConfig", "GroundSegmenter", "Learned", "PolarSurface", "segment_ground"]
