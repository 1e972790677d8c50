"""Boxes: the place, size and heading of what stands on the ground."""

from datmo.boxes.config import BoxConfig, CompleteConfig, FilterConfig, SizePrior
from datmo.boxes.fit import fit_boxes
from datmo.boxes.rules import Rejection
from datmo.boxes.shape import Shape, shapes

__all__ = [
    "BoxConfig",
    "CompleteConfig",
    "FilterConfig",
    "Rejection",
    "Shape",
    "SizePrior",
    "fit_boxes",
    "shapes",
]
