"""Boxes: the place, size and heading of what stands on the ground."""

from datmo.boxes.config import BoxConfig, FilterConfig, KindRule
from datmo.boxes.fit import fit_boxes
from datmo.boxes.rules import Rejection
from datmo.boxes.shape import Shape, shapes

__all__ = ["BoxConfig", "FilterConfig", "KindRule", "Rejection", "Shape", "fit_boxes", "shapes"]
