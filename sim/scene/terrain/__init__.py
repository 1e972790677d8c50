"""The ground: layers that add up to a height grid, and the grid as the simulator asks it."""

from sim.scene.terrain.build import build_terrain
from sim.scene.terrain.surface import Terrain

__all__ = ["Terrain", "build_terrain"]
