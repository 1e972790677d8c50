"""The gallery: contact sheets of every asset, ground and preset of scenery, each as a sensor sees it."""

from sim.picture.gallery.sheet import SHEETS, sheets

__all__ = ["SHEETS", "sheets"]
