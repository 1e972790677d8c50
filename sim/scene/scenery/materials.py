"""Diffuse reflectivity of what stands around, 0..1, at 905 nm.

Orders of magnitude after near-infrared spectra (USGS Spectral Library Version 7, Kokaly et al. 2017): green
leaves scatter half of it, bark and soil a third, galvanised steel and concrete a third to a half; window
glass itself next to nothing, but curtains and rooms are behind the panes of a house; a sign's sheeting
sends it back to where it came from.
"""

from __future__ import annotations

LEAF = 0.5
NEEDLE = 0.4
STRAW = 0.45
BARK = 0.3
STEEL = 0.3
ZINC = 0.4
CONCRETE = 0.35
RENDER = 0.45
BRICK = 0.35
ROOF = 0.25
GLASS = 0.05
WOOD = 0.4
PLASTIC = 0.2
SHEETING = 0.95
BLACK = 0.06
