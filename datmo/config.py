"""One frozen config a stage, in one tree; only the pipeline reads it whole."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict

from datmo.boxes import BoxConfig
from datmo.carry import CarryConfig
from datmo.clusters import ClusterConfig, MergeConfig, SplitConfig
from datmo.errors import ConfigError, nearest
from datmo.ground import METHODS, GroundConfig
from datmo.refine import RefineConfig
from datmo.tracks import TrackerConfig


class DatmoConfig(BaseModel):
    """Everything perception can be told; the defaults suit an HDL-64 on a car."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    refine: RefineConfig = RefineConfig()
    ground: GroundConfig = GroundConfig()
    clusters: ClusterConfig = ClusterConfig()
    split: SplitConfig = SplitConfig()
    carry: CarryConfig = CarryConfig()
    merge: MergeConfig = MergeConfig()
    boxes: BoxConfig = BoxConfig()
    tracks: TrackerConfig = TrackerConfig()

    def with_ground(self, method: str) -> DatmoConfig:
        """The same with another ground method.

        Raises:
            ConfigError: the method is unknown.
        """
        if method not in METHODS:
            raise ConfigError(f"ground method {method!r} is unknown; {nearest(method, METHODS)}")
        ground = self.ground.model_copy(update={"method": method})
        return self.model_copy(update={"ground": ground})
