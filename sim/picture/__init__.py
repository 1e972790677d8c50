"""Pictures from above: a raster, its colours, a scan with its truth."""

from sim.picture.birdseye import picture

__all__ = ["picture"]
